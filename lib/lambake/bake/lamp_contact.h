#pragma once

#include <cstddef>
#include <span>

#include "lambake/core/color.h"
#include "lambake/core/finding.h"
#include "lambake/scene/light.h"

namespace lambake {

/// Points on or next to a lamp, where light has no direction or no float holds it. Counts those exactly at
/// the position of a lamp or spot (they get nothing from it), and replaces colours that overflowed by those
/// of the lights that did not. O(V log L); nothing is read if all lights are suns that no sum can overflow.
/// @param positions  V vertices, or whatever points were lit.
/// @param normals    V unit vectors or (0,0,0).
/// @param colors     V: vertex base colour ⊗ E; non-finite where E overflowed.
/// @param base       V base colours, or none: white.
Findings tend_lamp_contacts(std::span<const Light> lights, std::span<const glm::vec3> positions,
                            std::span<const glm::vec3> normals, std::span<const LinearRgb> base,
                            std::span<LinearRgb> colors);

}  // namespace lambake
