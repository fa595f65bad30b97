#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "lambake/shading/patch.h"

/// Parts of a triangle, by the barycentrics of their corners, over which light can be integrated by a rule of
/// few places.
namespace lambake {

/// The triangle cut along the terminators of the lights with the indices `lights` (their chords, where they
/// are curves), in their order, as long as that makes no more than `most` parts: there light has its kinks.
std::vector<glm::dmat3> cut_at_terminators(const Patch& patch, std::span<const Light> all,
                                           std::span<const std::uint32_t> lights, std::size_t most);

/// Quarters parts where a light is nearer than a part is wide, or its cone narrower: what it lights must not
/// fall between the places looked at. Stops at some hundred parts more.
void quarter_wide_parts(const Patch& patch, std::span<const Light> all, std::span<const std::uint32_t> lights,
                        std::vector<glm::dmat3>& parts);

}  // namespace lambake
