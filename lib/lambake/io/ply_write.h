#pragma once

#include <string>

#include "lambake/bake/bake.h"
#include "lambake/io/color_storage.h"
#include "lambake/io/scene_file.h"

namespace lambake {

struct PlyWriteOptions {
  ColorStorage color =
      ColorStorage::u8;  ///< u8: uchar, sRGB-encoded, as MeshLab and Blender show them; f32: linear.
};

/// Writes a binary little-endian PLY, whole or not at all: positions, normals, texture coordinates if any,
/// and colour = base colour ⊗ baked light + emission (textures are sampled at the vertex). @throws IoError.
WrittenColors write_ply_file(const std::string& path, const Scene& scene, const BakedColors& baked,
                             const PlyWriteOptions& options);

}  // namespace lambake
