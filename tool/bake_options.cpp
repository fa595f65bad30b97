#include "bake_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "lambake/core/error.h"
#include "lambake/io/file_extension.h"
#include "lambake/io/gltf.h"
#include "lambake/io/ply_write.h"
#include "lambake/report/json_parts.h"
#include "options.h"

namespace lambake::tool {
namespace {

ColorStorage storage_from(const std::string& name, ColorStorage fallback) {
  if (name.empty()) return fallback;
  return name == "u8" ? ColorStorage::u8 : name == "u16" ? ColorStorage::u16 : ColorStorage::f32;
}

PlyWriteOptions ply_options(const OutputOptions& options) {
  return {.color = storage_from(options.color, ColorStorage::u8)};
}

GltfWriteOptions gltf_options(const OutputOptions& options) {
  return {.color = storage_from(options.color, ColorStorage::u16),
          .mark_unlit = options.mark_unlit,
          .attribute = options.attribute};
}

BakeMethod method_named(const std::string& name) {
  for (const BakeMethod method : {BakeMethod::face, BakeMethod::average, BakeMethod::least_squares,
                                  BakeMethod::uniform, BakeMethod::adaptive})
    if (name_of(method) == name) return method;
  return BakeMethod::sample;
}

/// Options that say nothing to some methods, and the methods that heed them.
struct MethodOption {
  const char* name;
  std::vector<std::string> methods;
};
const std::vector<MethodOption>& method_options() {
  static const std::vector<MethodOption> options{
      {"--tolerance", {"adaptive", "auto"}},
      {"--tolerance-space", {"adaptive", "auto"}},
      {"--max-vertices", {"adaptive", "auto"}},
      {"--max-seconds", {"adaptive", "auto"}},
      {"--gradient-weight", {"least-squares", "auto"}},
      {"--levels", {"uniform"}},
      {"--light-tolerance", {"sample", "face", "uniform", "auto"}}};
  return options;
}

void tell_unheeded(const BakeMethodOptions& options, Console& console) {
  for (const MethodOption& option : method_options())
    if (std::count(options.given.begin(), options.given.end(), option.name) > 0 &&
        std::count(option.methods.begin(), option.methods.end(), options.method) == 0)
      console.note(fmt::format("{} says nothing to --method {}; it is for {}", option.name, options.method,
                               fmt::join(option.methods, " and ")));
}

double parse_tolerance(const std::string& text, ErrorSpace space) {
  const double value = parse_quotient("--tolerance", text);
  if (!(value > 0))
    throw InvalidOption(fmt::format("--tolerance: expected a number above 0, found \"{}\"", text));
  if (space == ErrorSpace::display && value > 1)
    throw InvalidOption(
        fmt::format("--tolerance: expected at most 1, where the brightest is 1, found {}{}", text,
                    text.find('/') == std::string::npos ? fmt::format(" (in steps: {}/255)", text) : ""));
  return value;
}

/// Whether no light, of whatever strength, shows.
bool is_black(const Scene& scene) {
  const Mesh& mesh = scene.mesh;
  const std::vector<std::uint32_t> materials = vertex_materials(mesh);
  for (std::size_t v = 0; v < materials.size(); ++v) {
    const LinearRgb color = mesh.colors.empty() ? LinearRgb{1, 1, 1} : mesh.colors[v];
    if (!(scene.materials[materials[v]].base_color * color == LinearRgb{})) return false;
  }
  return true;
}

/// Tells where nothing of all that could be lit will be seen.
void tell_dark_vertices(const Scene& scene, BakedColors& baked) {
  const Mesh& mesh = mesh_of(scene, baked);
  const std::vector<std::uint32_t> materials = vertex_materials(mesh);
  float brightest = 0;
  std::size_t n_lit = 0;
  for (std::size_t v = 0; v < materials.size(); ++v) {
    const Material& material = scene.materials[materials[v]];
    if (material.is_unlit) return;
    if (!mesh.normals.empty() && mesh.normals[v] == glm::vec3(0)) continue;  // That is told already.
    const LinearRgb shown = material.base_color * baked.colors[v] + material.emission;
    brightest = std::max({brightest, shown.r, shown.g, shown.b});
    ++n_lit;
  }
  tell_darkness(scene, brightest, n_lit, "vert[ex is|ices are all]", baked.findings);
}

}  // namespace

void add_bake_options(CLI::App& command, BakeMethodOptions& options) {
  command
      .add_option("--method", options.method,
                  "how light becomes vertex colours: sample (Gouraud), face, average, least-squares, uniform "
                  "(quartered --levels times), adaptive (cut until the error is certified to be within the "
                  "tolerance), auto (the cheapest that is)")
      ->check(CLI::IsMember({"sample", "face", "average", "least-squares", "uniform", "adaptive", "auto"}))
      ->capture_default_str();
  command
      .add_option("--tolerance", options.tolerance,
                  "adaptive, auto: the largest difference to per-pixel lighting, e.g. 1/255 or 0.01")
      ->capture_default_str();
  command
      .add_option("--tolerance-space", options.tolerance_space,
                  "adaptive, auto: display (as a screen shows it) or linear")
      ->check(CLI::IsMember({"display", "linear"}))
      ->capture_default_str();
  command
      .add_option("--max-vertices", options.max_vertices,
                  "adaptive, auto: stop cutting before there are more; 0 is 8 times the scene's and 65,536")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{1} << 32));
  command
      .add_option("--max-seconds", options.max_seconds,
                  "adaptive, auto: stop cutting after this time; 0 is no limit")
      ->check(at_least_zero());
  command
      .add_option("--gradient-weight", options.gradient_weight,
                  "least-squares, auto: how much jumps of the colour's slope count against the error")
      ->check(at_least_zero())
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  command.add_option("--levels", options.levels, "uniform: how often each triangle is quartered")
      ->check(CLI::Range(0, 15))
      ->capture_default_str();
  command
      .add_option("--light-tolerance", options.light_tolerance,
                  "how far merging many lamps may move a colour on screen, where white is 1, certified; 0 "
                  "sums every lamp")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  for (const MethodOption& option : method_options())
    command.get_option(option.name)->each([&options, name = option.name](const std::string&) {
      options.given.emplace_back(name);
    });
}

BakeOptions bake_options(const BakeMethodOptions& options, Console& console) {
  if (std::isnan(options.light_tolerance)) throw InvalidOption("--light-tolerance: expected a number");
  BakeOptions result;
  result.method = method_named(options.method);
  result.tolerance_space = options.tolerance_space == "linear" ? ErrorSpace::linear : ErrorSpace::display;
  result.tolerance = parse_tolerance(options.tolerance, result.tolerance_space);
  result.max_vertices = options.max_vertices;
  result.max_seconds = options.max_seconds;
  result.gradient_weight = options.gradient_weight;
  result.levels = options.levels;
  result.light_tolerance = options.light_tolerance;
  result.progress = console.progress();
  return result;
}

BakedScene bake_scene(const Scene& scene, const BakeMethodOptions& options, BakeOptions how, Console& console,
                      const ColorOutput& output) {
  tell_unheeded(options, console);
  how.output = output;
  BakedScene result;
  result.tolerance = how.tolerance;
  if (options.method == "auto") {
    result.selection = select_method(scene, how);
    result.baked = std::move(result.selection->baked);
  } else {
    result.baked = bake(scene, how);
  }
  tell_dark_vertices(scene, result.baked);
  return result;
}

void add_method_json(nlohmann::ordered_json& json, const BakedScene& result) {
  if (const std::optional<Certificate>& c = result.baked.certificate) {
    constexpr double deg_per_rad = 57.29577951308232;
    json["certificate"] = {{"tolerance", result.tolerance},
                           {"certified", c->is_certified},
                           {"max_bound", c->max_bound},
                           {"open_triangles", c->open_triangles},
                           {"smallest_angle_deg_before", c->smallest_angle_before * deg_per_rad},
                           {"smallest_angle_deg_after", c->smallest_angle_after * deg_per_rad}};
  }
  if (!result.selection) return;
  json["auto"] = {{"verdict", result.selection->sentence},
                  {"method", name_of(result.selection->trials[result.selection->chosen].method)},
                  {"certified", result.selection->is_certified},
                  {"tolerance", result.tolerance},
                  {"trials", trials_json(result.selection->trials)}};
}

void add_output_options(CLI::App& command, OutputOptions& options) {
  command
      .add_option(
          "--color", options.color,
          "stored colours: u8, u16 (default of glTF), f32; PLY: u8 (default, sRGB-encoded) or f32 (linear)")
      ->check(CLI::IsMember({"u8", "u16", "f32"}));
  command.add_option("--attribute", options.attribute, "glTF: attribute that takes the light, e.g. _LIGHT")
      ->capture_default_str();
  command.add_flag("--unlit,!--no-unlit", options.mark_unlit,
                   "glTF: mark lit materials KHR_materials_unlit, so that nothing is lit twice (default)");
}

void tell_unheeded_outputs(const std::vector<std::string>& paths, const OutputOptions& options,
                           Console& console) {
  if (std::any_of(paths.begin(), paths.end(),
                  [](const std::string& path) { return file_extension(path) != "ply"; }))
    return;
  if (options.attribute != OutputOptions{}.attribute)
    console.note("--attribute says nothing to PLY; it is for glTF");
  if (!options.mark_unlit) console.note("--no-unlit says nothing to PLY; it is for glTF");
}

void tell_darkness(const Scene& scene, float brightest, std::size_t n, const std::string& what_is,
                   Findings& findings) {
  constexpr float visible = 0.5f / 255 / 12.92f;  // Half a step of the screen.
  if (scene.lights.empty() || !(brightest < visible)) return;
  add_finding(
      findings, "too_dark_to_see", n,
      what_is +
          (brightest > 0
               ? fmt::format(" too dark to be seen: the brightest has {:.1g} of white; a lamp fades with "
                             "the square of the distance, --exposure brightens",
                             brightest)
           : is_black(scene) ? " black, as the base colour is"
                             : " black: the lights are behind the surface, inside of it, out of reach, or "
                               "shine between the vertices"));
}

void check_baked_path(const std::string& path, const OutputOptions& options) {
  const std::string extension = file_extension(path);
  if (extension == "ply") {
    if (options.color == "u16") throw InvalidOption("--color u16: expected u8 or f32 for a .ply");
    return;
  }
  if (extension != "glb" && extension != "gltf")
    throw InvalidOption(fmt::format("-o {}: expected .glb, .gltf or .ply", path));
  if (extension == "gltf" && !std::filesystem::exists(path)) {
    const std::filesystem::path bin = std::filesystem::path(path).replace_extension(".bin");
    if (std::filesystem::exists(bin))
      throw InvalidOption(
          fmt::format("-o {}: would replace {}, which is of something else", path, bin.string()));
  }
  check_gltf_write_options(gltf_options(options));
}

void check_levels(const BakeMethodOptions& options, const std::string& path, const SceneFile& file) {
  if (options.method != "uniform" || file_extension(path) != "glb") return;
  // The least: of the new vertices those inside of triangles alone. What comes from a glTF keeps its types,
  // and several materials have indices of their own, which may be short.
  constexpr double most_bytes = 4294967295.0;
  const double index_size = file.scene.materials.size() > 1 ? 2 : 4;
  const double vertex_size = file.asset ? 6 + 4 : 12 + 12 + 4;  // Position, normal, colour.
  const double n_parts = std::exp2(options.levels);             // Of each edge.
  const auto n_before = static_cast<double>(file.scene.mesh.n_triangles());
  const double n_triangles = n_before * n_parts * n_parts;
  const double n_vertices = n_before * (n_parts - 1) * (n_parts - 2) / 2;
  const double n_bytes = 3 * index_size * n_triangles + vertex_size * n_vertices;
  if (n_bytes > most_bytes)
    throw InvalidOption(
        fmt::format("--levels {}: expected levels that a GLB can hold, of at most {:.0f} bytes, found {:.0f} "
                    "triangles, at least {:.0f} bytes",
                    options.levels, most_bytes, n_triangles, n_bytes));
}

ColorOutput output_of(const std::string& path, const SceneFile& file, const OutputOptions& options) {
  return file_extension(path) == "ply" ? ply_output(file.scene, ply_options(options))
                                       : gltf_output(file, gltf_options(options));
}

WrittenColors write_baked(const std::string& path, const SceneFile& file, const BakedColors& baked,
                          const OutputOptions& options) {
  if (file_extension(path) != "ply") return write_gltf_file(path, file, baked, gltf_options(options));
  WrittenColors written = write_ply_file(path, file.scene, baked, ply_options(options));
  const std::size_t n_objects = file.object_names.size();
  add_finding(written.findings, "objects_joined", n_objects > 1 ? n_objects : 0,
              "objects are one mesh in a PLY; their names are left out");
  return written;
}

std::uintmax_t baked_bytes(const std::string& path) {
  std::uintmax_t n_bytes = std::filesystem::file_size(path);
  const std::filesystem::path bin = std::filesystem::path(path).replace_extension(".bin");
  if (file_extension(path) == "gltf" && std::filesystem::exists(bin))
    n_bytes += std::filesystem::file_size(bin);
  return n_bytes;
}

}  // namespace lambake::tool
