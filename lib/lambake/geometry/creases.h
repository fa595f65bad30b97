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

/// Triangles that lean between 40 and 90 degrees from the normal at one of their corners, if those are a
/// tenth of all: sharp edges that are lit as if they were round. 0 if they are fewer, as single folds are in
/// every scan. O(F) where it finds them; otherwise 20,000 triangles are looked at.
/// @param mesh  with normals.
std::size_t count_smoothed_faces(const Mesh& mesh);

}  // namespace lambake
