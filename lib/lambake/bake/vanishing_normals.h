#pragma once

#include <cstddef>

#include "lambake/geometry/cutting.h"

namespace lambake {

/// Whether light per pixel has a direction to go by on a triangle; internal to the folder. Around a place
/// where the interpolated normal vanishes, its direction turns by the same angles at every scale: cutting
/// there would not end.
/// @param whole  the mesh before it was cut, with normals.
bool has_direction(const CutMesh& cut, const Mesh& whole, std::size_t triangle);

}  // namespace lambake
