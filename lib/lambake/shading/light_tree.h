#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>

#include "lambake/core/color.h"
#include "lambake/scene/light.h"

namespace lambake {

/// An upper bound of how far light is from the plain sum over all lights in exact arithmetic, over all points
/// and channels. The rounding of plainly summed lights is not in it.
struct LightError {
  double linear = 0;
  double display = 0;  ///< After the sRGB curve, for surfaces of any albedo up to 1.
};

/// E(p, n) of many points under many lights, parallel.
///
/// A plain sum (to the last bit irradiance() of shading/light_kernel.h, error 0) if `tolerance_display` is 0
/// or there are few lights. Otherwise points that lie and face alike are taken together: lights of falloff
/// 1/d² behind all of them are left out, and far ones are merged into one field or left out where the
/// certified error, after the sRGB curve, adds up to at most `tolerance_display`; the rest is summed. Lights
/// of other kinds are summed. Deterministic: the same bits for any number of threads and on any vector path.
/// @param tolerance_display  in steps of the encoded range [0,1], e.g. 0.1/255; >= 0.
/// @param positions, normals, out  as irradiance() takes them. Errors as of it.
LightError irradiance_within(std::span<const Light> lights, double tolerance_display,
                             std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                             std::span<LinearRgb> out);

}  // namespace lambake
