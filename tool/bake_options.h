#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "console.h"
#include "lambake/bake/bake.h"
#include "lambake/io/color_storage.h"
#include "lambake/io/scene_file.h"
#include "lambake/measure/select.h"

namespace lambake::tool {

/// How light becomes vertex colours; for every command that bakes.
struct BakeMethodOptions {
  std::string method = "sample";
  std::string tolerance = "1/255";
  std::string tolerance_space = "display";
  std::size_t max_vertices = 0;
  double max_seconds = 0;
  double gradient_weight = BakeOptions{}.gradient_weight;
  int levels = BakeOptions{}.levels;
  double light_tolerance = BakeOptions{}.light_tolerance;
  std::vector<std::string> given{};  ///< Names of the options that only some methods heed, as given.
};

/// How lit meshes are stored.
struct OutputOptions {
  std::string color;  ///< "u8", "u16", "f32"; empty: the format's default.
  std::string attribute = "COLOR_0";
  bool mark_unlit = true;
};

void add_bake_options(CLI::App& command, BakeMethodOptions& options);
/// For every method but auto, which is none of the library's.
BakeOptions bake_options(const BakeMethodOptions& options, Console& console);

/// What bake() makes, or for auto what the method chosen makes, and why.
struct BakedScene {
  BakedColors baked;
  std::optional<Selection> selection;  ///< Only for auto; its `baked` is moved out.
  double tolerance = 0;
};

/// @param how  bake_options() of `options`. @param output  what becomes of the colours; what is certified is
/// that.
BakedScene bake_scene(const Scene& scene, const BakeMethodOptions& options, BakeOptions how, Console& console,
                      const ColorOutput& output);

/// The certificate, and for auto the trials, where there are any.
void add_method_json(nlohmann::ordered_json& json, const BakedScene& result);

/// Tells which of them say nothing, as no output is glTF.
void tell_unheeded_outputs(const std::vector<std::string>& paths, const OutputOptions& options,
                           Console& console);

void add_output_options(CLI::App& command, OutputOptions& options);

/// Adds a finding where there is light, but nothing of it would be seen.
/// @param brightest  channel of all that could be lit. @param n  how many those are.
/// @param what_is    their name with "is" and "are", as findings have it.
void tell_darkness(const Scene& scene, float brightest, std::size_t n, const std::string& what_is,
                   Findings& findings);

/// Throws InvalidOption unless `path` ends in .glb, .gltf or .ply and the options fit it.
void check_baked_path(const std::string& path, const OutputOptions& options);

/// Throws InvalidOption if uniform cuts make more than a GLB can hold, where `path` is one, before time and
/// memory go into them.
void check_levels(const BakeMethodOptions& options, const std::string& path, const SceneFile& file);

/// What write_baked() makes of colours.
ColorOutput output_of(const std::string& path, const SceneFile& file, const OutputOptions& options);

/// Writes a lit mesh by extension.
WrittenColors write_baked(const std::string& path, const SceneFile& file, const BakedColors& baked,
                          const OutputOptions& options);

/// The size of what write_baked() has written: of a .gltf with the .bin beside it.
std::uintmax_t baked_bytes(const std::string& path);

}  // namespace lambake::tool
