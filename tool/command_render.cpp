#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "bake_options.h"
#include "commands.h"
#include "lambake/core/digits.h"
#include "lambake/core/error.h"
#include "lambake/io/color_storage.h"
#include "lambake/io/file_extension.h"
#include "lambake/io/image_file.h"
#include "lambake/render/shade.h"
#include "lambake/report/json_parts.h"
#include "options.h"

namespace lambake::tool {
namespace {

struct RenderCommand {
  SceneOptions scene;
  CameraOptions camera;
  std::string shading = "fragment";
  std::vector<std::string> outputs;
};

void check_picture_path(const std::string& path) {
  const std::string extension = file_extension(path);
  if (extension != "png" && extension != "exr")
    throw InvalidOption(fmt::format("-o {}: expected .png or .exr", path));
}

/// Tells what a screen does not show of the picture.
/// @param is_clipped  an output holds at most 1.
void tell_brightness(const Picture& picture, std::size_t n_covered, bool is_clipped, LoadedScene& loaded,
                     Console& console) {
  Findings findings;
  std::size_t n_above = 0;
  if (is_clipped)
    for (const LinearRgb& c : picture.pixels) n_above += std::max({c.r, c.g, c.b}) > 1 + 0.5f / 255;
  const float brightest = brightest_of(picture.pixels);
  add_finding(findings, "overexposed_pixels", n_above,
              fmt::format("of {} pixels [is|are] brighter than white ({} shows them)",
                          group_digits(n_covered), exposure_to_white(brightest)));
  tell_darkness(loaded.file.scene, brightest, n_covered, "pixel[ is|s are all]", findings);
  console.tell(findings);
  loaded.file.findings.insert(loaded.file.findings.end(), findings.begin(), findings.end());
}

int render_and_write(const RenderCommand& command) {
  Console console(command.scene.quiet);
  Stopwatch stopwatch;
  check_camera_options(command.camera);
  const glm::uvec2 size = picture_size(command.camera);
  for (const std::string& path : command.outputs) {
    check_picture_path(path);
    check_keeps_input(command.scene, path, path);
  }
  check_distinct(command.outputs);
  LoadedScene loaded =
      load_scene(command.scene, console, stopwatch, up_of(command.camera), command.shading == "face");
  for (const std::string& path : command.outputs) check_keeps_referred(loaded.file, path, path);
  tell_drawn_opaque(loaded, console);
  const Scene& scene = loaded.file.scene;
  const Camera camera = choose_camera(command.camera, scene, size);
  console.stage("rendering");
  Picture picture;
  std::size_t n_covered = 0;
  if (command.shading == "fragment") {
    n_covered = render_per_fragment(scene, camera, size.x, size.y, picture);
  } else {
    const BakedColors baked =
        bake(scene, bake_options({.method = command.shading == "face" ? "face" : "sample"}, console));
    stopwatch.lap("bake");
    console.tell(baked.findings);
    loaded.file.findings.insert(loaded.file.findings.end(), baked.findings.begin(), baked.findings.end());
    n_covered = render_per_vertex(scene, baked, camera, size.x, size.y, picture);
  }
  stopwatch.lap("render");
  console.clear_bar();
  const bool has_png = std::any_of(command.outputs.begin(), command.outputs.end(),
                                   [](const std::string& path) { return file_extension(path) == "png"; });
  tell_brightness(picture, n_covered, has_png, loaded, console);
  if (n_covered == 0) console.note("the picture shows nothing of the model");
  for (const std::string& path : command.outputs) {
    write_picture(path, picture);
    if (command.scene.tells_people()) print_result("{}: {}x{} pixels\n", path, size.x, size.y);
  }
  stopwatch.lap("write");
  if (command.scene.json) {
    nlohmann::ordered_json json;
    json["input"] = input_name(command.scene);
    json["format"] = loaded.file.format;
    json["shading"] = command.shading;
    json["width"] = size.x;
    json["height"] = size.y;
    json["covered_pixels"] = n_covered;
    json["triangles"] = scene.mesh.n_triangles();
    json["lights"] = scene.lights.size();
    json["outputs"] = command.outputs;
    json["findings"] = findings_json(loaded.file.findings);
    json["seconds"] = seconds_json(stopwatch.seconds());
    print_result("{}\n", json_text(json));
  }
  return 0;
}

}  // namespace

void add_render_command(CLI::App& app, Run& run) {
  auto command = std::make_shared<RenderCommand>();
  CLI::App& sub =
      *app.add_subcommand("render", "render with light per pixel, per vertex or per face: PNG, EXR");
  add_scene_options(sub, command->scene);
  add_camera_options(sub, command->camera);
  sub.add_option("--shading", command->shading, "where the light is evaluated: fragment, vertex or face")
      ->check(CLI::IsMember({"fragment", "vertex", "face"}))
      ->capture_default_str();
  sub.add_option("-o,--output", command->outputs, ".png (sRGB) or .exr (linear float) to write; repeatable")
      ->required()
      ->allow_extra_args(false);
  sub.footer("Example: lambake render bunny.ply --shading vertex --size 1920x1080 -o bunny.png -o bunny.exr");
  sub.callback(
      [command, &run] { run = [command](const std::string&) { return render_and_write(*command); }; });
}

}  // namespace lambake::tool
