#pragma once

#include <cstdint>
#include <span>

#include "lambake/core/color.h"
#include "lambake/shading/finish.h"
#include "lambake/shading/patch.h"

namespace lambake {

/// The error along a side of a triangle, and where a cut would mend it; internal to the folder.
struct SideError {
  double error = 0;  ///< The largest |F − G| found, at the brightest finish.
  double bulge = 0;  ///< How far the error leaves the straight line between those at the ends, at most.
  double t = 0.5;    ///< Where it does: from corner 0 to corner 1.
};

/// Samples the side from corner 0 to corner 1 of `patch` where its error has peaks: at the terminators that
/// cross it, between, and climbing from the best. A lower estimate, not a bound.
/// @param lights  the indices of those of `all` that reach the patch.
SideError side_error(const Patch& patch, const FinishRange& finish, std::span<const Light> all,
                     std::span<const std::uint32_t> lights, ErrorSpace space);

}  // namespace lambake
