#include "bake_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "lambake/core/error.h"
#include "lambake/io/gltf.h"
#include "lambake/io/ply_write.h"

namespace lambake::tool {
namespace {

std::string lower_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

ColorStorage storage_from(const std::string& name, ColorStorage fallback) {
  if (name.empty()) return fallback;
  return name == "u8" ? ColorStorage::u8 : name == "u16" ? ColorStorage::u16 : ColorStorage::f32;
}

}  // namespace

void add_bake_options(CLI::App& command, BakeMethodOptions& options) {
  command
      .add_option("--method", options.method, "how light becomes vertex colours: sample (Gouraud) or face")
      ->check(CLI::IsMember({"sample", "face"}))
      ->capture_default_str();
}

BakeOptions bake_options(const BakeMethodOptions& options, Console& console) {
  BakeOptions result;
  result.method = options.method == "face" ? BakeMethod::face : BakeMethod::sample;
  result.progress = console.progress();
  return result;
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

void check_baked_path(const std::string& path, const OutputOptions& options) {
  const std::string extension = lower_extension(path);
  if (extension == ".ply") {
    if (options.color == "u16") throw InvalidOption("--color u16: expected u8 or f32 for a .ply");
    return;
  }
  if (extension != ".glb" && extension != ".gltf")
    throw InvalidOption(fmt::format("-o {}: expected .glb, .gltf or .ply", path));
}

WrittenColors write_baked(const std::string& path, const SceneFile& file, const BakedColors& baked,
                          const OutputOptions& options) {
  if (lower_extension(path) == ".ply")
    return write_ply_file(path, file.scene, baked, {.color = storage_from(options.color, ColorStorage::u8)});
  return write_gltf_file(path, file, baked,
                         {.color = storage_from(options.color, ColorStorage::u16),
                          .mark_unlit = options.mark_unlit,
                          .attribute = options.attribute});
}

}  // namespace lambake::tool
