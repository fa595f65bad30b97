#pragma once

#include <cstdint>
#include <span>

#include "lambake/core/color.h"
#include "lambake/shading/finish.h"
#include "lambake/shading/patch.h"

namespace lambake {

/// How far to move the colours at the corners of a triangle so that its error at one place comes down to
/// `allowed`; internal to the folder. Column k for corner k, linear; 0 in the channels that need nothing or
/// where that cannot be had.
///
/// Where light is smooth, colours that are right at the vertices leave an error of one sign between them.
/// Moved by up to `allowed` (as compared) at the vertices, they may leave twice that. Each corner moves by
/// the same share of what it may.
/// @param exact  column k: the reference at corner k. @param b  barycentrics of the place.
/// @param lights  the indices of those of `all` that reach the patch.
glm::dmat3 balancing_shifts(const Patch& patch, const glm::dmat3& exact, const FinishRange& finish,
                            std::span<const Light> all, std::span<const std::uint32_t> lights,
                            const glm::dvec3& b, double allowed, ErrorSpace space);

}  // namespace lambake
