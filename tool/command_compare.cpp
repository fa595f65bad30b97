#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <memory>
#include <utility>

#include "bake_options.h"
#include "commands.h"
#include "lambake/core/digits.h"
#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/core/version.h"
#include "lambake/io/image_file.h"
#include "lambake/io/output_file.h"
#include "lambake/io/output_folder.h"
#include "lambake/io/ply_write.h"
#include "lambake/measure/bound.h"
#include "lambake/measure/error_shares.h"
#include "lambake/measure/image_error.h"
#include "lambake/measure/light_share.h"
#include "lambake/measure/surface_error.h"
#include "lambake/render/framing.h"
#include "lambake/render/parent_hits.h"
#include "lambake/render/shade.h"
#include "lambake/report/report.h"
#include "options.h"
#include "thresholds.h"

namespace lambake::tool {
namespace {

struct CompareCommand {
  SceneOptions scene;
  CameraOptions camera;
  BakeMethodOptions method;
  OutputOptions output;
  std::string folder;
  std::size_t n_views = 1;
  std::vector<std::string> thresholds;  ///< "METRIC=VALUE".
};

/// Both pictures of every view and their errors; those of the first view stay for the report.
void compare_views(const CompareCommand& command, const Scene& scene, const BakedColors& baked,
                   Console& console, Comparison& comparison) {
  const glm::uvec2 size = picture_size(command.camera);
  std::vector<Camera> cameras = {choose_camera(command.camera, scene, size)};
  if (command.n_views > 1)
    cameras =
        frame_around(positions_in_faces(scene.mesh), static_cast<float>(size.x) / static_cast<float>(size.y),
                     command.n_views, up_of(command.camera));
  console.stage("pictures");
  const Progress progress = console.progress();
  std::vector<ImageError> linear, display;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    report_progress(progress, "pictures", static_cast<double>(i) / static_cast<double>(cameras.size()));
    Visibility visibility = find_visibility(scene, mesh_of(scene, baked), cameras[i], size.x, size.y);
    Picture per_vertex = shade_per_vertex(scene, baked, visibility);
    visibility = parent_hits(scene, baked, std::move(visibility));
    Picture per_fragment = shade_per_fragment(scene, visibility);
    linear.push_back(compare_pictures(per_vertex, per_fragment, visibility, ErrorSpace::linear));
    display.push_back(compare_pictures(per_vertex, per_fragment, visibility, ErrorSpace::display));
    comparison.seen_from_behind += count_seen_from_behind(scene, visibility, cameras[i]);
    if (i > 0) continue;
    comparison.per_vertex = std::move(per_vertex);
    comparison.per_fragment = std::move(per_fragment);
    comparison.visibility = std::move(visibility);
  }
  comparison.n_views = cameras.size();
  comparison.image_linear = combine(linear);
  comparison.image_display = combine(display);
  if (comparison.image_display.pixels == 0) console.note("the picture shows nothing of the model");
}

/// The mesh that carries the colours, each triangle in the colour of its worst difference.
void write_surface_error(const std::string& path, const Mesh& mesh, const SurfaceError& error, double scale) {
  std::vector<float> steps = error.triangle_worst;
  for (float& step : steps) step *= 255;
  write_face_ply(
      path, mesh, heat_colors(error.triangle_worst, scale), steps,
      fmt::format("quality: largest difference on screen in steps of 1/255, above 0 where per vertex is "
                  "brighter; the colours end at {:.4g}",
                  scale * 255));
}

constexpr const char* output_names[] = {
    "per_vertex.png",    "per_fragment.png", "per_vertex.exr", "per_fragment.exr", "difference.png",
    "surface_error.ply", "lit.glb",          "lit.ply",        "report.json",      "index.html"};

/// What would fail only once the work is done.
void check_outputs(const CompareCommand& command) {
  check_output_folder(command.folder);
  check_page_is_ours(command.folder, "compare");
  for (const char* name : output_names)
    check_keeps_input(command.scene, std::filesystem::path(command.folder) / name, command.folder);
  check_camera_options(command.camera);
  if (command.n_views > 1 && (!command.camera.eye.empty() || !command.camera.camera.empty()))
    throw InvalidOption("--views: expected no --eye or --camera with it, as the views go around the model");
  check_baked_path("lit.glb", command.output);
}

/// What a comparison says before anything is compared.
Comparison describe(const CompareCommand& command, const std::string& command_line, const LoadedScene& loaded,
                    const BakedScene& result) {
  const Scene& scene = loaded.file.scene;
  const Mesh& mesh = mesh_of(scene, result.baked);
  Comparison comparison;
  comparison.input = input_name(command.scene);
  comparison.command = command_line;
  comparison.version = version();
  comparison.method = command.method.method;
  comparison.normals = loaded.normals;
  comparison.n_vertices = mesh.n_vertices();
  comparison.n_triangles = mesh.n_triangles();
  comparison.n_lights = scene.lights.size();
  comparison.n_scene_vertices = scene.mesh.n_vertices();
  comparison.n_scene_triangles = scene.mesh.n_triangles();
  for (const Light& light : scene.lights) comparison.light_names.push_back(light.name);
  comparison.light_shares = light_shares(scene);
  comparison.findings = loaded.file.findings;
  comparison.findings.insert(comparison.findings.end(), result.baked.findings.begin(),
                             result.baked.findings.end());
  if (result.selection) {
    comparison.verdict = result.selection->sentence;
    comparison.trials = result.selection->trials;
  }
  return comparison;
}

/// What most of the error on screen is, if not interpolation: found by comparing the colours as computed.
std::string main_loss(const Scene& scene, const BakedColors& baked, const ColorOutput& output,
                      const Comparison& comparison) {
  const std::vector<bool> hidden = hidden_emission(scene, output);
  const bool is_clipped = comparison.shares.clipping > comparison.shares.interpolation,
             is_hidden = std::find(hidden.begin(), hidden.end(), true) != hidden.end();
  if (!is_clipped && !is_hidden) return {};
  const double without = surface_error(scene, baked, ErrorSpace::display).rmse;
  if (2 * without > comparison.surface_display.rmse) return {};
  return is_hidden ? "light that materials emit and lit.glb cannot hold"
                   : "light brighter than white, which vertex colours cannot hold";
}

/// The errors of the colours as `output` holds them; `baked` comes back as it was.
void measure(const CompareCommand& command, const Scene& scene, const ColorOutput& output, BakedColors& baked,
             Console& console, Stopwatch& stopwatch, Comparison& comparison) {
  std::vector<LinearRgb> computed = baked.colors;
  take_stored_colors(scene, output, baked);
  baked.hidden_emission = hidden_emission(scene, output);
  compare_views(command, scene, baked, console, comparison);
  stopwatch.lap("pictures");
  console.stage("surface error");
  SurfaceErrors errors = surface_errors(scene, baked, computed);
  comparison.surface_linear = std::move(errors.linear);
  comparison.surface_display = std::move(errors.display);
  stopwatch.lap("surface");
  console.stage("certified bound");
  // Triangles that cannot be worse than the worst place found need no closer look.
  const auto bound_in = [&](ErrorSpace space, const SurfaceError& error) {
    return bound_in_output(scene, output, space, certified_maximum(scene, baked, space, error.max_sampled));
  };
  comparison.max_bound_linear = bound_in(ErrorSpace::linear, comparison.surface_linear);
  comparison.max_bound_display = bound_in(ErrorSpace::display, comparison.surface_display);
  stopwatch.lap("bound");
  baked.colors = std::move(computed);
  baked.hidden_emission.clear();
  comparison.shares = error_shares(scene, baked, output, errors.computed_rmse);
  comparison.main_loss = main_loss(scene, baked, output, comparison);
}

void write_pictures(const OutputFolder& folder, const Mesh& mesh, const Comparison& c) {
  const double scale = heat_map_scale(c.per_vertex, c.per_fragment, c.visibility);
  const Picture difference = heat_map(c.per_vertex, c.per_fragment, c.visibility, scale);
  const std::pair<const char*, const Picture&> pictures[] = {{"per_vertex.exr", c.per_vertex},
                                                             {"per_fragment.exr", c.per_fragment},
                                                             {"per_vertex.png", c.per_vertex},
                                                             {"per_fragment.png", c.per_fragment},
                                                             {"difference.png", difference}};
  parallel_blocks(std::size(pictures), 1, [&](std::size_t i, std::size_t) {
    write_picture(folder.file(pictures[i].first), pictures[i].second);
  });
  write_surface_error(folder.file("surface_error.ply"), mesh, c.surface_display, scale);
}

/// The lit meshes; what is noticed of both is told once, what is of one with its name.
void write_meshes(const OutputFolder& folder, const CompareCommand& command, const SceneFile& file,
                  const BakedColors& baked, Console& console, Comparison& comparison) {
  const OutputOptions ply_output = {.color = command.output.color == "u16" ? "" : command.output.color};
  const std::pair<const char*, const OutputOptions&> outputs[] = {{"lit.glb", command.output},
                                                                  {"lit.ply", ply_output}};
  Findings findings[2];
  for (int i = 0; i < 2; ++i) {
    WrittenColors written = write_baked(folder.file(outputs[i].first), file, baked, outputs[i].second);
    findings[i] = std::move(written.findings);
    comparison.clipped_vertices = std::max(comparison.clipped_vertices, written.clipped_vertices);
  }
  const auto has = [](const Findings& all, const Finding& one) {
    return std::any_of(all.begin(), all.end(),
                       [&](const Finding& f) { return f.count == one.count && f.text == one.text; });
  };
  Findings news;
  for (int i = 0; i < 2; ++i)
    for (Finding finding : findings[i]) {
      const bool is_of_both = has(findings[1 - i], finding);
      if (has(comparison.findings, finding) || (i > 0 && is_of_both)) continue;
      if (!is_of_both) finding.text += fmt::format(" ({})", outputs[i].first);
      news.push_back(finding);
    }
  console.tell(news);
  comparison.findings.insert(comparison.findings.end(), news.begin(), news.end());
}

void print_summary(const Comparison& comparison) {
  const ImageError& image = comparison.image_display;
  const SurfaceError& surface = comparison.surface_display;
  print_result("per vertex against per pixel, on screen, in steps of 1/255\n");
  if (image.pixels == 0)
    print_result("  picture   shows nothing of the model\n");
  else
    print_result("  picture   rmse {:.3f}  max {:.1f}  {} of {} {} off by more than one step\n",
                 image.rmse * 255, image.max * 255, group_digits(image.pixels_over_1_255),
                 group_digits(image.pixels), in_number(image.pixels, "pixel[|s]"));
  const double bound = *comparison.max_bound_display;
  print_result(
      "  surface   rmse {:.3f}  max {:.1f} found, {}\n", surface.rmse * 255, surface.max_sampled * 255,
      std::isfinite(bound) ? fmt::format("{:.1f} certified", round_up(bound * 255, 1)) : "none certified");
}

int compare_and_write(const CompareCommand& command, const std::string& command_line) {
  Console console(command.scene.quiet);
  Stopwatch stopwatch;
  const std::vector<Threshold> thresholds = parse_thresholds(command.thresholds);
  check_outputs(command);
  const BakeOptions how = bake_options(command.method, console);

  LoadedScene loaded = load_scene(command.scene, console, stopwatch, up_of(command.camera));
  for (const char* name : output_names)
    check_keeps_referred(loaded.file, std::filesystem::path(command.folder) / name, command.folder);
  tell_drawn_opaque(loaded, console);
  const Scene& scene = loaded.file.scene;
  check_levels(command.method, "lit.glb", loaded.file);
  // Before the work: it may not be there.
  choose_camera(command.camera, scene, picture_size(command.camera));
  console.stage("baking");
  const ColorOutput output = output_of("lit.glb", loaded.file, command.output);
  BakedScene result = bake_scene(scene, command.method, how, console, output);
  BakedColors& baked = result.baked;
  const bool tells_gaps = baked.certificate || result.selection;
  if (!tells_gaps) baked.findings.insert(baked.findings.end(), output.gaps.begin(), output.gaps.end());
  console.tell(baked.findings);
  stopwatch.lap("bake");

  Comparison comparison = describe(command, command_line, loaded, result);
  comparison.tolerance_space = how.tolerance_space;
  measure(command, scene, output, baked, console, stopwatch, comparison);

  console.stage("writing");
  OutputFolder folder(command.folder);
  write_pictures(folder, mesh_of(scene, baked), comparison);
  write_meshes(folder, command, loaded.file, baked, console, comparison);
  stopwatch.lap("write");
  comparison.seconds = stopwatch.seconds();
  const std::string report = report_json(comparison);
  write_file(folder.file("report.json"), report);
  write_file(folder.file("index.html"), report_page(comparison));
  folder.commit();

  console.clear_bar();
  if (command.scene.json) {
    print_result("{}\n", report);
  } else if (!command.scene.quiet) {
    print_summary(comparison);
    print_result("{}\n", (std::filesystem::path(command.folder) / "index.html").string());
  }
  return check_thresholds(thresholds, nlohmann::ordered_json::parse(report));
}

}  // namespace

void add_compare_command(CLI::App& app, Run& run) {
  auto command = std::make_shared<CompareCommand>();
  CLI::App& sub =
      *app.add_subcommand("compare", "both shadings, their difference in numbers, pictures and a page");
  add_scene_options(sub, command->scene);
  add_camera_options(sub, command->camera);
  add_bake_options(sub, command->method);
  add_output_options(sub, command->output);
  sub.add_option("-o,--output", command->folder, "folder to write into; made if it is not there")->required();
  sub.add_option("--views", command->n_views, "take the errors over this many views around the model")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  sub.add_option("--fail-above", command->thresholds,
                 "exit with 1 if METRIC=VALUE is exceeded; rmse, mae, max, p99 are of the picture on screen, "
                 "in [0,1] (3/255 is three steps), others by path in report.json, e.g. "
                 "surface.linear.rmse=0.01; repeatable")
      ->allow_extra_args(false);
  sub.footer("Example: lambake compare bunny.ply --sun 0.4,1,0.3 -o out/bunny --fail-above rmse=0.01");
  sub.callback([command, &run] {
    run = [command](const std::string& command_line) { return compare_and_write(*command, command_line); };
  });
}

}  // namespace lambake::tool
