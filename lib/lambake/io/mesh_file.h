#pragma once

#include <string>

#include "lambake/io/scene_file.h"

namespace lambake {

/// Reads .ply .obj .off .stl .om through OpenMesh's readers into plain arrays (docs/file-formats.md).
///
/// File order and vertex count are kept; polygons are triangulated, concave ones too; corners of a vertex
/// that differ in normal, texture coordinate, face colour or material split it (Mesh::source_vertices).
/// Positions of STL that are exactly equal are welded. Colours are decoded from sRGB to linear. Whatever was
/// repaired, left out or odd is a finding.
/// @throws IoError if the file is truncated, names a vertex that it does not have, has a token that is no
///         number, promises more than it can hold, or has no faces.
SceneFile read_mesh_file(const std::string& path);

}  // namespace lambake
