#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "console.h"
#include "lambake/bake/bake.h"
#include "lambake/io/color_storage.h"
#include "lambake/io/scene_file.h"

namespace lambake::tool {

/// How light becomes vertex colours; for every command that bakes.
struct BakeMethodOptions {
  std::string method = "sample";
};

/// How lit meshes are stored.
struct OutputOptions {
  std::string color;  ///< "u8", "u16", "f32"; empty: the format's default.
  std::string attribute = "COLOR_0";
  bool mark_unlit = true;
};

void add_bake_options(CLI::App& command, BakeMethodOptions& options);
BakeOptions bake_options(const BakeMethodOptions& options, Console& console);

void add_output_options(CLI::App& command, OutputOptions& options);

/// Throws InvalidOption unless `path` ends in .glb, .gltf or .ply and the options fit it.
void check_baked_path(const std::string& path, const OutputOptions& options);

/// Writes a lit mesh by extension.
WrittenColors write_baked(const std::string& path, const SceneFile& file, const BakedColors& baked,
                          const OutputOptions& options);

}  // namespace lambake::tool
