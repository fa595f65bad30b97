#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "lambake/core/color.h"
#include "lambake/scene/light.h"

namespace lambake {

/// Lights laid out for irradiance() over many points: runs of lights that need the same arithmetic, in the
/// order of the lights. Made once, read by any number of threads.
struct PackedLights {
  enum class Kind {
    directional,     ///< Reads no position.
    inverse_square,  ///< A point with k = 2 and no range.
    general          ///< Everything else.
  };
  struct Source {
    glm::vec3 place;  ///< directional: the direction to the light; otherwise its position.
    LinearRgb intensity;
  };
  struct Run {
    Kind kind;
    std::size_t begin, end;  ///< In `sources`; for general runs also in `general`, from `general_begin`.
    std::size_t general_begin;
  };
  std::vector<Source> sources;  ///< One per light.
  std::vector<Light> general;   ///< The lights of the general runs.
  std::vector<Run> runs;
  bool needs_positions = false;  ///< Some light is not directional.
};

PackedLights pack_lights(std::span<const Light> lights);

/// E(p, n) of every point, as irradiance<float>() of shading/lambert.h gives it, to the last bit: the vector
/// forms do the same IEEE operations in the same order, so the result depends on neither the machine's vector
/// path nor on how the points are cut into calls. One thread; no allocation.
/// @param positions  N, or empty if the lights do not need them; a non-finite one gets light from directional
///                   lights only.
/// @param normals    N unit vectors, or (0,0,0), which gets no light.
/// @param out        N, overwritten.
/// @throws InvalidOption if the lengths differ.
void irradiance(const PackedLights& lights, std::span<const glm::vec3> positions,
                std::span<const glm::vec3> normals, std::span<LinearRgb> out);

}  // namespace lambake
