#pragma once

#include <span>
#include <string>

#include "lambake/bake/bake.h"
#include "lambake/io/color_storage.h"
#include "lambake/scene/scene.h"

namespace lambake {

struct PlyWriteOptions {
  ColorStorage color =
      ColorStorage::u8;  ///< u8: uchar, sRGB-encoded, as MeshLab and Blender show them; f32: linear.
};

/// Writes a binary little-endian PLY, whole or not at all: positions, normals, texture coordinates if any,
/// and colour = base colour ⊗ baked light + emission (textures are sampled at the vertex).
/// @throws IoError; InvalidOption for u16; InvalidScene if `baked` does not fit the scene.
WrittenColors write_ply_file(const std::string& path, const Scene& scene, const BakedColors& baked,
                             const PlyWriteOptions& options);

/// What a certificate has to know of such a file.
ColorOutput ply_output(const Scene& scene, const PlyWriteOptions& options);

/// Writes a binary little-endian PLY, whole or not at all: the mesh's positions, and for each triangle its
/// colour (uchar red green blue, sRGB-encoded) and a number (float quality, as MeshLab calls it).
/// @param comment  one line for the header that says what the number is. @throws IoError.
void write_face_ply(const std::string& path, const Mesh& mesh, std::span<const Srgb8> colors,
                    std::span<const float> quality, const std::string& comment);

}  // namespace lambake
