#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "lambake/core/color.h"
#include "lambake/shading/enclosure.h"
#include "lambake/shading/finish.h"
#include "lambake/shading/patch.h"

namespace lambake {

struct BoundOptions {
  ErrorSpace space = ErrorSpace::display;
  double accept = 0;  ///< A bound this small is not improved further.
  /// Stops where an error above this is found: the answer is known.
  double reject = std::numeric_limits<double>::infinity();
  double tightness = 1.1;  ///< A bound of at most this multiple of an error that was found is good enough.
  int max_parts = 400;     ///< Enclosures computed at most.
};

/// What is known of the largest |F − G| over a patch and its channels.
struct PatchBound {
  double bound = 0;  ///< Never below the truth; infinite where a light lies on the surface.
  double found = 0;  ///< Never above it.
  glm::dvec3 found_at{1, 0, 0};
};

/// Bounds the difference between the reference and the interpolated colours over a patch: enclosures of the
/// equation, and branch and bound on parts of the patch (docs/bound.md).
/// @param lights  those of `all` that reach the patch.
PatchBound bound_patch(const Patch& patch, const FinishRange& finish, std::span<const Light> all,
                       std::span<const std::uint32_t> lights, const BoundOptions& options);

/// Encloses max(0, N·ω)/‖N‖ · f(d), what a surface receives of one light, over a patch. Infinite where it has
/// no bound.
Enclosure light_over(const Light& light, const Patch& patch);

}  // namespace lambake
