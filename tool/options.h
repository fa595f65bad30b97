#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "console.h"
#include "lambake/io/scene_file.h"
#include "lambake/render/framing.h"

namespace lambake::tool {

/// What every command that reads a scene takes.
struct SceneOptions {
  std::string input;
  std::string lights_file;
  std::vector<std::string> suns, lamps;  ///< "X,Y,Z[,R,G,B]" and "X,Y,Z[,R,G,B[,DECAY]]".
  bool no_file_lights = false;
  std::string gltf_scene;
  std::string albedo;  ///< "R,G,B".
  std::string normals = "auto";
  std::optional<float> crease_angle_deg;
  float exposure_stops = 0;
  std::size_t threads = 0;
  bool json = false;
  bool quiet = false;

  /// Whether standard output is for people.
  bool tells_people() const { return !json && !quiet; }
};

/// The input's name without folders.
std::string input_name(const SceneOptions& options);

struct CameraOptions {
  std::string camera;       ///< Name or number of a camera of the file.
  std::string eye, target;  ///< "X,Y,Z".
  std::optional<float> fov_deg;
  std::string up;  ///< "y", "z"; empty: not asked for.
  std::string size = "1024x768";
};

void add_scene_options(CLI::App& command, SceneOptions& options);
void add_camera_options(CLI::App& command, CameraOptions& options);

/// The scene ready to be lit: read, lights added, exposure applied, creases split, normals made.
struct LoadedScene {
  SceneFile file;
  std::string normals;  ///< What the vertex normals are, e.g. "file", "angle, creases at 30 degrees".
};

/// Laps "read" and "normals" on the stopwatch; notes and findings are told on the console.
/// @param up       the sun that is taken where there is no light comes from there.
/// @param is_flat  faces are lit by their own normals: what vertex normals smooth does not show.
LoadedScene load_scene(const SceneOptions& options, Console& console, Stopwatch& stopwatch, Up up = Up::y,
                       bool is_flat = false);

/// Pictures do not blend what is transparent: tells it, among the findings too.
void tell_drawn_opaque(LoadedScene& loaded, Console& console);

/// The size of the picture, at least 1 and at most max_picture_side a side. @throws InvalidOption.
glm::uvec2 picture_size(const CameraOptions& options);

/// What is wrong with them whatever the scene. @throws InvalidOption.
void check_camera_options(const CameraOptions& options);

Up up_of(const CameraOptions& options);

/// The camera asked for, or the scene's first one, or an automatic framing of the model.
/// @throws InvalidOption if there is no such camera.
Camera choose_camera(const CameraOptions& options, const Scene& scene, const glm::uvec2& size);

/// Comma-separated numbers, between `min_count` and `max_count` of them. @throws InvalidOption naming
/// `option`.
std::vector<float> parse_numbers(const std::string& option, const std::string& text, std::size_t min_count,
                                 std::size_t max_count);

/// One finite number, or a quotient of two: "1/255". @throws InvalidOption naming `option`.
double parse_quotient(const std::string& option, std::string_view text);

/// @throws InvalidOption if two outputs are one file.
void check_distinct(const std::vector<std::string>& outputs);

/// @throws InvalidOption, naming the output as it was given, if writing the file at `path` would replace the
/// input or the lights file.
void check_keeps_input(const SceneOptions& options, const std::filesystem::path& path,
                       const std::string& output);

/// The same for the materials, buffers and images that the input refers to.
void check_keeps_referred(const SceneFile& file, const std::filesystem::path& path,
                          const std::string& output);

/// @throws IoError if the folder has an index.html that the command, as on the command line, has not written.
void check_page_is_ours(const std::string& folder, const std::string& command);

/// For CLI11: finite numbers of at least 0, or above 0.
CLI::Validator at_least_zero();
CLI::Validator above_zero();

}  // namespace lambake::tool
