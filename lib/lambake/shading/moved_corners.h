#pragma once

#include <glm/glm.hpp>

#include "lambake/core/color.h"
#include "lambake/shading/finish.h"
#include "lambake/shading/patch.h"

namespace lambake {

/// How much an interpolated colour changes, as compared, where the corners of its patch are stored elsewhere:
/// the vertices that cuts make are rounded to float.
///
/// An upper bound over the patch and its channels, for places in the plane of the patch; what leaves the
/// plane is a change of the surface and not of its light. 0 for a patch without area.
/// @param stored  the corners in the output, as columns.
double change_by_moved_corners(const Patch& patch, const FinishRange& finish, const glm::dmat3& stored,
                               ErrorSpace space);

}  // namespace lambake
