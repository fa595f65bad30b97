#pragma once

#include <string>

#include "lambake/bake/bake.h"
#include "lambake/io/color_storage.h"
#include "lambake/io/scene_file.h"

namespace lambake {

/// Reads .gltf and .glb. @throws IoError, InvalidScene.
SceneFile read_gltf_file(const std::string& path, const ReadOptions& options);

struct GltfWriteOptions {
  ColorStorage color = ColorStorage::u16;
  bool mark_unlit = true;             ///< KHR_materials_unlit, so that nothing is lit twice.
  std::string attribute = "COLOR_0";  ///< Or another, e.g. "_LIGHT", for engines with a shader of their own.
};

/// @throws InvalidOption unless the attribute is COLOR_0 or a name of the application's own.
void check_gltf_write_options(const GltfWriteOptions& options);

/// Writes a .glb or .gltf (+ .bin), whole or not at all: for a scene from a glTF file the asset as it was
/// with its light added, otherwise a new asset with the mesh's arrays. @throws IoError.
WrittenColors write_gltf_file(const std::string& path, const SceneFile& file, const BakedColors& baked,
                              const GltfWriteOptions& options);

/// What a certificate has to know of such a file.
ColorOutput gltf_output(const SceneFile& file, const GltfWriteOptions& options);

}  // namespace lambake
