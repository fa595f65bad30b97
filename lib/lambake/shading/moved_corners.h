#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <glm/glm.hpp>

#include "lambake/core/color.h"
#include "lambake/scene/mesh.h"
#include "lambake/shading/finish.h"
#include "lambake/shading/patch.h"

namespace lambake {

/// Where an output has the corners of a patch.
struct StoredCorners {
  glm::dmat3 positions;                  ///< As columns.
  double rounding = 0;                   ///< Each may be this far off in any direction.
  std::array<TexelCorners, 2> texels{};  ///< Of the base colour and of the emission, if the corners moved.
};

/// The corners of a triangle as `mesh`, which may be cut, has them in float.
/// @param uncut  the mesh before the cuts. @param n_uncut  vertices of `mesh` that no cut made.
/// @param parent  the triangle of `uncut` that this one lies in.
StoredCorners stored_corners(const Mesh& mesh, std::size_t triangle, const Finishes& finishes,
                             const Mesh& uncut, std::size_t n_uncut, std::size_t parent);

/// How much an interpolated colour changes, as compared, where the corners of its patch are stored elsewhere:
/// the vertices that cuts make are rounded to float.
///
/// An upper bound over the patch and its channels, for places in the plane of the patch; what leaves the
/// plane is a change of the surface and not of its light. Textures move with the corners; up to 1/256 of a
/// texel, the step in which GPUs weigh texels, that is no change. 0 for a patch without area.
double change_by_moved_corners(const Patch& patch, const FinishRange& finish, const StoredCorners& stored,
                               ErrorSpace space);

/// A bound of the error with such a change added; on screen nothing is more than 1 off.
inline double bound_with_change(double bound, double change, ErrorSpace space) {
  return space == ErrorSpace::linear ? bound + change : std::min(bound + change, std::max(bound, 1.0));
}

}  // namespace lambake
