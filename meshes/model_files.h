#pragma once

#include <string>

#include "lambake/scene/mesh.h"

/// The formats that the models of this folder are written in: bytes of a whole file, the same on every run.
namespace lambake {

enum class PlyFormat { ascii, little_endian, big_endian };

/// PLY with positions, and normals and colours (uchar, sRGB-encoded) where the mesh has them.
std::string ply_bytes(const Mesh& mesh, PlyFormat format);

/// OBJ with positions, and normals where the mesh has them; the vertices of a face share one index for both.
std::string obj_bytes(const Mesh& mesh);

std::string off_bytes(const Mesh& mesh);

/// STL: each triangle has its own three corners and the normal of its plane.
std::string stl_ascii_bytes(const Mesh& mesh, const std::string& name);
std::string stl_binary_bytes(const Mesh& mesh, const std::string& header);

}  // namespace lambake
