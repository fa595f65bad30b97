#pragma once

#include <glm/glm.hpp>
#include <string>

#include "lambake/core/color.h"

namespace lambake {

enum class LightType { directional, point, spot };

/// A light in world space. Its units are those of the equation: a white surface of albedo 1 that faces a
/// directional light of intensity 1, or a point light of intensity 1 at distance 1, has the colour (1,1,1).
struct Light {
  LightType type = LightType::directional;
  std::string name{};
  LinearRgb intensity{1, 1, 1};           ///< Colour × intensity; finite, each >= 0.
  glm::vec3 direction_to_light{0, 1, 0};  ///< directional: unit, from the surface towards the light.
  glm::vec3 position{0, 0, 0};            ///< point, spot.
  float decay = 2;                        ///< point, spot: exponent k >= 0 of the falloff 1/d^k.
  float range = 0;                        ///< point, spot: distance where the window reaches 0; 0 is none.
  glm::vec3 spot_direction{0, 0, -1};     ///< spot: unit, the way the light shines.
  float inner_cone_rad = 0;               ///< spot: half angle of full light; 0 <= inner <= outer.
  float outer_cone_rad = 0.78539816f;     ///< spot: half angle where the light ends; above 0, at most π/2.
};

/// Throws InvalidOption if a number is not finite, negative where it may not be, a direction is not a unit
/// vector, or the cone is none. `where` begins the message, e.g. "lights.json: light 2".
void check_light(const Light& light, const std::string& where);

}  // namespace lambake
