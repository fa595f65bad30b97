#include "lambake/scene/light.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "lambake/core/bounds.h"
#include "lambake/core/error.h"

namespace lambake {

void check_light(const Light& light, const std::string& where) {
  const auto expect = [&](bool holds, const char* what) {
    if (!holds) throw InvalidOption(where + ": " + what);
  };
  const auto is_unit = [](const glm::vec3& v) { return std::abs(glm::length(v) - 1.0f) < 1e-4f; };
  const LinearRgb& c = light.intensity;
  expect(is_finite(c) && c.r >= 0 && c.g >= 0 && c.b >= 0,
         "expected a finite color and intensity of at least 0");
  if (light.type == LightType::directional) {
    expect(is_unit(light.direction_to_light), "expected a finite direction that is not zero");
    return;
  }
  expect(is_finite(light.position), "expected a finite position");
  expect(std::isfinite(light.decay) && light.decay >= 0, "expected a finite decay of at least 0");
  expect(std::isfinite(light.range) && light.range >= 0, "expected a finite range of at least 0 (0 is none)");
  if (light.type == LightType::spot) {
    expect(is_unit(light.spot_direction), "expected a finite direction that is not zero");
    expect(light.inner_cone_rad >= 0 && light.inner_cone_rad <= light.outer_cone_rad &&
               light.outer_cone_rad > 0 && light.outer_cone_rad <= std::numbers::pi_v<float> / 2 + 1e-6f,
           "expected cone angles 0 <= inner <= outer <= 90 degrees with outer above 0");
  }
}

}  // namespace lambake
