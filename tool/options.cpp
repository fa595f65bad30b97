#include "options.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <set>
#include <system_error>

#include "lambake/core/bounds.h"
#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/geometry/creases.h"
#include "lambake/geometry/normals.h"
#include "lambake/geometry/robust_normals.h"
#include "lambake/io/light_file.h"
#include "lambake/io/output_file.h"
#include "lambake/render/framing.h"
#include "lambake/render/visibility.h"

namespace lambake::tool {
namespace {

constexpr float rad_per_deg = std::numbers::pi_v<float> / 180;

/// The whole text as a finite number, or none.
template <typename Number>
std::optional<Number> number_of(std::string_view text) {
  Number number = 0;
  const char* const end = text.data() + text.size();
  const auto [next, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || next != end || !std::isfinite(static_cast<double>(number))) return std::nullopt;
  return number;
}

LinearRgb color_from(const std::string& option, const std::vector<float>& numbers, std::size_t first) {
  if (numbers.size() <= first) return {1, 1, 1};
  const LinearRgb color{numbers[first], numbers[first + 1], numbers[first + 2]};
  if (color.r < 0 || color.g < 0 || color.b < 0)
    throw InvalidOption(fmt::format("{}: expected a color of at least 0 in each channel", option));
  return color;
}

Light parse_sun(const std::string& text) {
  const std::vector<float> n = parse_numbers("--sun", text, 3, 6);
  if (n.size() != 3 && n.size() != 6)
    throw InvalidOption(fmt::format("--sun: expected X,Y,Z or X,Y,Z,R,G,B, found \"{}\"", text));
  const glm::dvec3 direction(n[0], n[1], n[2]);
  if (glm::length(direction) == 0)
    throw InvalidOption("--sun: expected a direction that is not zero, found 0,0,0");
  Light light;
  light.type = LightType::directional;
  light.direction_to_light = glm::vec3(direction / glm::length(direction));
  light.intensity = color_from("--sun", n, 3);
  return light;
}

Light parse_lamp(const std::string& text) {
  const std::vector<float> n = parse_numbers("--lamp", text, 3, 7);
  if (n.size() != 3 && n.size() != 6 && n.size() != 7)
    throw InvalidOption(
        fmt::format("--lamp: expected X,Y,Z, X,Y,Z,R,G,B or X,Y,Z,R,G,B,DECAY, found \"{}\"", text));
  Light light;
  light.type = LightType::point;
  light.position = {n[0], n[1], n[2]};
  light.intensity = color_from("--lamp", n, 3);
  if (n.size() == 7) light.decay = n[6];
  check_light(light, "--lamp");
  return light;
}

/// @param notes  takes what people should know: a default taken.
void add_lights(const SceneOptions& options, Up up, std::vector<Light>& lights,
                std::vector<std::string>& notes) {
  if (!options.lights_file.empty())
    for (const Light& light : read_light_file(options.lights_file)) lights.push_back(light);
  for (const std::string& sun : options.suns) lights.push_back(parse_sun(sun));
  for (const std::string& lamp : options.lamps) lights.push_back(parse_lamp(lamp));
  const bool was_asked = !options.lights_file.empty() || options.no_file_lights;
  if (lights.empty() && !was_asked) {
    const char* const from = up == Up::z ? "0.4,-0.3,1" : "0.4,1,0.3";
    lights.push_back(parse_sun(from));
    notes.push_back(
        fmt::format("no light given: one white sun from {} (choose with --sun, --lamp or --lights)", from));
  }
  if (lights.empty()) notes.push_back("no light at all: only emission and unlit materials show");
  std::map<std::string, std::size_t> counts;
  for (Light& light : lights) {
    const char* kind = light.type == LightType::directional ? "sun"
                       : light.type == LightType::point     ? "lamp"
                                                            : "spot";
    const std::string name = fmt::format("{} {}", kind, ++counts[kind]);
    light.name = light.name.empty() ? name : fmt::format("{} ({})", name, light.name);
  }
}

LinearRgb parse_albedo(const std::string& text) {
  const std::vector<float> n = parse_numbers("--albedo", text, 3, 3);
  for (const float channel : n)
    if (channel < 0 || channel > 1)
      throw InvalidOption(fmt::format("--albedo: expected three numbers in [0,1], found \"{}\"", text));
  return {n[0], n[1], n[2]};
}

void apply_albedo(const std::string& text, SceneFile& file) {
  if (text.empty()) return;
  const LinearRgb albedo = parse_albedo(text);
  if (file.asset == nullptr) {
    for (Material& material : file.scene.materials) material.base_color = material.base_color * albedo;
    return;
  }
  // The materials of a glTF asset go back as they were: its vertices carry the albedo, but those of unlit
  // materials, which stay as they are.
  Mesh& mesh = file.scene.mesh;
  mesh.colors.resize(mesh.n_vertices(), LinearRgb{1, 1, 1});
  const std::vector<std::uint32_t> materials = vertex_materials(mesh);
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v)
    if (!file.scene.materials[materials[v]].is_unlit) mesh.colors[v] = mesh.colors[v] * albedo;
}

/// Base colours without a texture become vertex colours, as a lit mesh file has one colour for both: what its
/// storage clips is then the colour that is seen. The materials of a glTF asset stay, as they are written
/// back.
void fold_base_colors(SceneFile& file) {
  if (file.asset != nullptr) return;
  Scene& scene = file.scene;
  Mesh& mesh = scene.mesh;
  const auto folds = [&](const Material& m) {
    return m.base_color_texture == no_texture && m.base_color != LinearRgb{1, 1, 1};
  };
  if (std::none_of(scene.materials.begin(), scene.materials.end(), folds)) return;
  std::vector<LinearRgb> factors(mesh.n_vertices(), LinearRgb{1, 1, 1});  // A vertex has one material.
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    const Material& material = scene.materials[mesh.material_of(f)];
    if (folds(material))
      for (int c = 0; c < 3; ++c) factors[mesh.triangles[f][c]] = material.base_color;
  }
  mesh.colors.resize(mesh.n_vertices(), LinearRgb{1, 1, 1});
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v) mesh.colors[v] = mesh.colors[v] * factors[v];
  for (Material& material : scene.materials)
    if (folds(material)) material.base_color = {1, 1, 1};
}

/// What is wrong whatever the file. @throws InvalidOption.
void check_scene_options(const SceneOptions& options) {
  for (const std::string& sun : options.suns) parse_sun(sun);
  for (const std::string& lamp : options.lamps) parse_lamp(lamp);
  if (!options.albedo.empty()) parse_albedo(options.albedo);
  if (!std::isfinite(options.exposure_stops) || std::abs(options.exposure_stops) > 64)
    throw InvalidOption(
        fmt::format("--exposure: expected stops in [-64, 64], found {}", options.exposure_stops));
  const float degrees = options.crease_angle_deg.value_or(0);
  if (!(degrees >= 0 && degrees <= 180))
    throw InvalidOption(fmt::format("--crease-angle-deg: expected degrees in [0, 180], found {}", degrees));
  if (options.normals == "file" && options.crease_angle_deg)
    throw InvalidOption(
        "--crease-angle-deg: expected no --normals file with it, as creases make new normals");
}

void apply_exposure(float stops, Scene& scene) {
  const float scale = std::exp2(stops);
  bool is_held = true;
  const auto expose = [&](LinearRgb& color) {
    color = color * scale;
    is_held &= is_finite(color);
  };
  for (Light& light : scene.lights) expose(light.intensity);
  for (Material& material : scene.materials) expose(material.emission);
  if (!is_held)
    throw InvalidOption(
        fmt::format("--exposure: expected light that a float holds, found more at {} stops", stops));
}

void make_normals(const SceneOptions& options, bool is_flat, LoadedScene& loaded) {
  Mesh& mesh = loaded.file.scene.mesh;
  Findings& findings = loaded.file.findings;
  std::string method = options.normals;
  if (method == "auto") method = mesh.normals.empty() || options.crease_angle_deg ? "angle" : "file";
  if (method == "file") {
    if (mesh.normals.empty()) throw InvalidOption("--normals file: the file has no normals");
    loaded.normals = "file";
    return;
  }
  loaded.normals = method;
  if (options.crease_angle_deg) {
    const float degrees = *options.crease_angle_deg;
    const std::size_t n_added = split_creases(mesh, degrees * rad_per_deg);
    loaded.normals += fmt::format(", creases at {} degrees", degrees);
    add_finding(findings, "crease_vertices", n_added,
                fmt::format("vert[ex|ices] added where faces meet at more than {} degrees", degrees));
  }
  const NormalWeight weight = method == "angle"     ? NormalWeight::angle
                              : method == "area"    ? NormalWeight::area
                              : method == "uniform" ? NormalWeight::uniform
                                                    : NormalWeight::max;
  VertexNormals made = method == "robust" ? robust_normals(mesh) : vertex_normals(mesh, weight);
  mesh.normals = std::move(made.normals);
  add_finding(findings, "vertices_without_direction", made.undefined,
              "vert[ex has|ices have] no normal ([its|their] faces have no area or cancel); [it gets|they "
              "get] no light");
  if (options.normals == "auto" && !options.crease_angle_deg && !is_flat)
    add_finding(findings, "smoothed_faces", count_smoothed_faces(mesh),
                "face[ leans|s lean] more than 40 degrees from the normals at [its|their] corners: sharp "
                "edges are lit as if they were round (--crease-angle-deg 30 keeps them sharp)");
}

double parse_number(const std::string& option, std::string_view text) {
  if (const std::optional<double> number = number_of<double>(text)) return *number;
  throw InvalidOption(fmt::format("{}: expected a finite number, found \"{}\"", option, text));
}

CLI::Validator number_check(const char* expected, bool takes_zero) {
  const auto check = [expected, takes_zero](const std::string& text) -> std::string {
    const std::optional<double> number = number_of<double>(text);
    const bool is_sound = number && (*number > 0 || (takes_zero && *number == 0));
    return is_sound ? "" : fmt::format("expected a finite number {}, found \"{}\"", expected, text);
  };
  return {check, ""};
}

}  // namespace

std::string input_name(const SceneOptions& options) {
  return std::filesystem::path(options.input).filename().string();
}

std::vector<float> parse_numbers(const std::string& option, const std::string& text, std::size_t min_count,
                                 std::size_t max_count) {
  const auto fail = [&](const std::string& found) -> void {
    throw InvalidOption(fmt::format(
        "{}: expected {} finite numbers separated by commas, found {}", option,
        min_count == max_count ? std::to_string(min_count) : fmt::format("{} to {}", min_count, max_count),
        found));
  };
  std::vector<float> numbers;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::optional<float> number = number_of<float>(std::string_view(text).substr(begin, end - begin));
    if (!number) fail(fmt::format("\"{}\"", text));
    numbers.push_back(*number);
    begin = end + 1;
  }
  if (numbers.size() < min_count || numbers.size() > max_count)
    fail(fmt::format("{} in \"{}\"", numbers.size(), text));
  return numbers;
}

double parse_quotient(const std::string& option, std::string_view text) {
  const std::size_t slash = text.find('/');
  const double value = parse_number(option, text.substr(0, slash));
  if (slash == std::string_view::npos) return value;
  const double quotient = value / parse_number(option, text.substr(slash + 1));
  if (!std::isfinite(quotient))
    throw InvalidOption(fmt::format("{}: expected a finite number, found \"{}\"", option, text));
  return quotient;
}

void check_distinct(const std::vector<std::string>& outputs) {
  std::set<std::filesystem::path> seen;
  std::error_code ignored;  // Of folders that are not there.
  for (const std::string& output : outputs)
    if (!seen.insert(std::filesystem::weakly_canonical(std::filesystem::absolute(target_of(output)), ignored))
             .second)
      throw InvalidOption(fmt::format("-o {}: expected each file once", output));
}

void check_keeps_input(const SceneOptions& options, const std::filesystem::path& path,
                       const std::string& output) {
  std::error_code ignored;  // Of a file that is not there yet.
  if (std::filesystem::equivalent(options.input, path, ignored))
    throw InvalidOption(fmt::format("-o {}: would replace the input", output));
  if (std::filesystem::equivalent(options.lights_file, path, ignored))
    throw InvalidOption(fmt::format("-o {}: would replace the lights file", output));
}

void check_keeps_referred(const SceneFile& file, const std::filesystem::path& path,
                          const std::string& output) {
  std::error_code ignored;  // Of files that are not there.
  for (const std::string& referred : file.referred_files)
    if (std::filesystem::equivalent(referred, path, ignored))
      throw InvalidOption(fmt::format("-o {}: would replace {}, which the input needs", output, referred));
}

void check_page_is_ours(const std::string& folder, const std::string& command) {
  const std::filesystem::path path = std::filesystem::path(folder) / "index.html";
  std::error_code ignored;  // Of a page that is not there.
  if (!std::filesystem::exists(path, ignored)) return;
  std::string head(4096, '\0');
  if (std::filesystem::is_regular_file(path, ignored))
    std::ifstream(path, std::ios::binary).read(head.data(), static_cast<std::streamsize>(head.size()));
  if (head.find(fmt::format("<meta name=\"generator\" content=\"lambake {}\">", command)) ==
      std::string::npos)
    throw IoError(path.string(),
                  fmt::format("expected a page of lambake {} to replace, found another; choose a "
                              "folder for the output",
                              command));
}

CLI::Validator at_least_zero() {
  return number_check("of at least 0", true);
}

CLI::Validator above_zero() {
  return number_check("above 0", false);
}

void add_scene_options(CLI::App& command, SceneOptions& options) {
  command.add_option("INPUT", options.input, "mesh or scene: .ply .obj .off .stl .om .gltf .glb")->required();
  command.add_option("--sun", options.suns, "directional light, towards it: X,Y,Z[,R,G,B]; repeatable")
      ->allow_extra_args(false);
  command.add_option("--lamp", options.lamps, "point light: X,Y,Z[,R,G,B[,DECAY]]; repeatable")
      ->allow_extra_args(false);
  command.add_option("--lights", options.lights_file, "lights file (docs/lights.schema.json)");
  command.add_flag("--no-file-lights", options.no_file_lights, "leave out the lights of a glTF file");
  command.add_option("--scene", options.gltf_scene, "scene of a glTF file, by name or number");
  command.add_option("--albedo", options.albedo,
                     "multiplies the base colour of what is lit: R,G,B in [0,1], linear");
  command
      .add_option("--normals", options.normals,
                  "auto (the file's, else angle), file, angle, area, uniform, max or robust")
      ->check(CLI::IsMember({"auto", "file", "angle", "area", "uniform", "max", "robust"}));
  command.add_option("--crease-angle-deg", options.crease_angle_deg,
                     "split vertices where faces meet at more than this");
  command.add_option("--exposure", options.exposure_stops, "scale lights and emission by 2^STOPS");
  command.add_option("--threads", options.threads, "number of threads; 0 is all")->check(CLI::Range(0, 4096));
  command.add_flag("--json", options.json, "numbers as JSON on standard output, nothing else there");
  command.add_flag("--quiet", options.quiet, "say nothing but errors");
}

void add_camera_options(CLI::App& command, CameraOptions& options) {
  command.add_option("--camera", options.camera, "camera of the file, by name or number");
  command.add_option("--eye", options.eye, "where the camera stands: X,Y,Z");
  command.add_option("--target", options.target,
                     "with --eye: what it looks at: X,Y,Z (default: the model's centre)");
  command.add_option("--fov-deg", options.fov_deg,
                     "with --eye: vertical angle of view in degrees (default 35)");
  command
      .add_option("--up", options.up,
                  "which axis of the model points up in the picture: y (default) or z, as in CAD and on maps")
      ->check(CLI::IsMember({"y", "z"}));
  command.add_option("--size", options.size, "picture size WIDTHxHEIGHT")->capture_default_str();
}

LoadedScene load_scene(const SceneOptions& options, Console& console, Stopwatch& stopwatch, Up up,
                       bool is_flat) {
  check_scene_options(options);
  set_thread_count(options.threads);
  LoadedScene loaded;
  std::vector<std::string> notes;  // Told once nothing can fail any more.
  console.stage("reading");
  // Normals that are made anyway need no copies of vertices.
  const bool keeps_normals =
      (options.normals == "auto" && !options.crease_angle_deg) || options.normals == "file";
  loaded.file = read_scene_file(options.input, {.gltf_scene = options.gltf_scene,
                                                .use_file_lights = !options.no_file_lights,
                                                .shade_flat = keeps_normals});
  stopwatch.lap("read");
  if (!options.gltf_scene.empty() && loaded.file.asset == nullptr)
    notes.push_back(fmt::format("--scene says nothing to {}; it is for glTF", loaded.file.format));
  console.stage("normals");
  add_lights(options, up, loaded.file.scene.lights, notes);
  apply_albedo(options.albedo, loaded.file);
  fold_base_colors(loaded.file);
  apply_exposure(options.exposure_stops, loaded.file.scene);
  make_normals(options, is_flat, loaded);
  stopwatch.lap("normals");
  const Scene& scene = loaded.file.scene;
  std::size_t n_lit = 0;
  for (std::size_t f = 0; f < scene.mesh.n_triangles(); ++f)
    n_lit += !scene.materials[scene.mesh.material_of(f)].is_unlit;
  if (n_lit == 0) notes.push_back("every material is unlit: colours stay as they are, nothing is lit");
  for (const std::string& note : notes) console.note(note);
  console.tell(loaded.file.findings);
  return loaded;
}

void tell_drawn_opaque(LoadedScene& loaded, Console& console) {
  const Scene& scene = loaded.file.scene;
  std::vector<bool> is_blended(scene.materials.size());
  for (std::size_t f = 0; f < scene.mesh.n_triangles(); ++f) {
    const std::uint32_t m = scene.mesh.material_of(f);
    is_blended[m] = scene.materials[m].alpha_mode == AlphaMode::blend;
  }
  Findings findings;
  add_finding(findings, "drawn_opaque",
              static_cast<std::size_t>(std::count(is_blended.begin(), is_blended.end(), true)),
              "material[ blends|s blend] with what is behind [it|them]; drawn as if [it|they] did not");
  console.tell(findings);
  loaded.file.findings.insert(loaded.file.findings.end(), findings.begin(), findings.end());
}

glm::uvec2 picture_size(const CameraOptions& options) {
  const std::string_view text = options.size;
  const std::size_t x = std::min(text.find('x'), text.size());
  const std::optional<unsigned> width = number_of<unsigned>(text.substr(0, x));
  const std::optional<unsigned> height = number_of<unsigned>(text.substr(std::min(x + 1, text.size())));
  const auto is_sound = [](const std::optional<unsigned>& side) {
    return side && *side >= 1 && *side <= max_picture_side;
  };
  if (!is_sound(width) || !is_sound(height))
    throw InvalidOption(fmt::format("--size: expected WIDTHxHEIGHT, each from 1 to {}, found \"{}\"",
                                    max_picture_side, text));
  return {*width, *height};
}

void check_camera_options(const CameraOptions& options) {
  picture_size(options);
  const bool has_place = !options.eye.empty(), has_more = !options.target.empty() || options.fov_deg;
  if (!options.camera.empty() && (has_place || has_more || !options.up.empty()))
    throw InvalidOption("--camera: expected no --eye, --target, --fov-deg or --up with it");
  if (has_more && !has_place)
    throw InvalidOption(
        fmt::format("{}: expected --eye with it", options.fov_deg ? "--fov-deg" : "--target"));
  if (has_place) parse_numbers("--eye", options.eye, 3, 3);
  if (!options.target.empty()) parse_numbers("--target", options.target, 3, 3);
  if (options.fov_deg && !(*options.fov_deg > 0 && *options.fov_deg < 180))
    throw InvalidOption(
        fmt::format("--fov-deg: expected an angle above 0 and below 180, found {}", *options.fov_deg));
}

Up up_of(const CameraOptions& options) {
  return options.up == "z" ? Up::z : Up::y;
}

Camera choose_camera(const CameraOptions& options, const Scene& scene, const glm::uvec2& size) {
  const float aspect = static_cast<float>(size.x) / static_cast<float>(size.y);
  if (!options.camera.empty()) {
    for (const Camera& camera : scene.cameras)
      if (camera.name == options.camera) return camera;
    const std::optional<std::size_t> number = number_of<std::size_t>(options.camera);
    if (number && *number < scene.cameras.size()) return scene.cameras[*number];
    std::string names;
    for (std::size_t i = 0; i < scene.cameras.size(); ++i)
      names += fmt::format("{}{} \"{}\"", i == 0 ? "" : ", ", i, scene.cameras[i].name);
    throw InvalidOption(fmt::format("--camera: expected one of the file's cameras ({}), found \"{}\"",
                                    names.empty() ? "it has none" : names, options.camera));
  }
  const std::vector<glm::vec3> shown = positions_in_faces(scene.mesh);
  if (!options.eye.empty()) {
    const Bounds bounds = bounds_of(shown);
    const std::vector<float> eye = parse_numbers("--eye", options.eye, 3, 3);
    glm::vec3 target = bounds.is_empty() ? glm::vec3(0) : bounds.center();
    if (!options.target.empty()) {
      const std::vector<float> t = parse_numbers("--target", options.target, 3, 3);
      target = {t[0], t[1], t[2]};
    }
    Camera camera = look_at({eye[0], eye[1], eye[2]}, target, options.fov_deg.value_or(35.0f) * rad_per_deg,
                            up_of(options));
    camera.near_distance = std::max(1e-4f * bounds.radius(), 1e-30f);
    return camera;
  }
  if (!scene.cameras.empty() && options.up.empty()) return scene.cameras.front();
  return frame(shown, aspect, up_of(options));
}

}  // namespace lambake::tool
