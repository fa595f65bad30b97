#pragma once

#include <cstddef>

#include "lambake/scene/mesh.h"

namespace lambake {

/// Splits vertices where faces meet at more than `crease_angle_rad`, so that each side gets its own normal.
/// Copies come after the vertices there are; normals of the mesh are dropped. Edges with other than two faces
/// are creases. O(F log F).
/// @param crease_angle_rad  angle between the normals of two faces, in [0, π].
/// @returns how many vertices were added.
std::size_t split_creases(Mesh& mesh, float crease_angle_rad);

}  // namespace lambake
