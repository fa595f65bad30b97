#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <span>

#include "lambake/scene/light.h"

/// The equation, once (docs/conventions.md):
///
///     P(p, n) = Le + D ⊗ Σ_i  max(0, n·ω_i) · L_i · f_i(d_i)
///
/// The baker, the renderer, the error measures and the reference all call this; vectorised forms are
/// tested against it.
namespace lambake {

/// f_i(d): 1/d^k times the range window of KHR_lights_punctual, max(0, min(1, 1 − (d/range)^4)).
template <typename Real>
Real falloff(const Light& light, Real distance_squared) {
  Real f = 1;
  const Real k = light.decay;
  if (k == Real(2)) {
    f = Real(1) / distance_squared;
  } else if (k == Real(1)) {
    f = Real(1) / std::sqrt(distance_squared);
  } else if (k == Real(4)) {
    f = Real(1) / distance_squared;
    f *= f;
  } else if (k != Real(0)) {
    f = std::pow(distance_squared, Real(-0.5) * k);
  }
  if (light.range > 0) {
    const Real ratio_squared = distance_squared / (Real(light.range) * Real(light.range));
    f *= std::clamp(Real(1) - ratio_squared * ratio_squared, Real(0), Real(1));
  }
  return f;
}

/// 1 − cos x, to the last bits near 0 too.
template <typename Real>
Real versine(Real x) {
  const Real s = std::sin(x / 2);
  return 2 * s * s;
}

/// The cone of KHR_lights_punctual: 1 within the inner angle, 0 beyond the outer one, squared ramp between.
/// `to_light` is the unit vector ω from the point towards the light. In versines, as cosines of narrow cones
/// are next to 1.
template <typename Real>
Real spot_cone(const Light& light, const glm::vec<3, Real>& to_light) {
  const Real outer = versine(Real(light.outer_cone_rad));
  const Real scale = Real(1) / std::max(Real(0.001), outer - versine(Real(light.inner_cone_rad)));
  const glm::vec<3, Real> off = glm::vec<3, Real>(light.spot_direction) + to_light;  // 2 sin(θ/2) long
  const Real ramp = std::clamp((outer - glm::dot(off, off) / 2) * scale, Real(0), Real(1));
  return ramp * ramp;
}

/// max(0, n·ω) · f(d): what light `light` gives at `position` to a surface of unit normal `normal`, without
/// its colour. 0 for a normal of (0,0,0), where the light lies on the point (no direction) and where the
/// squared distance is not finite.
template <typename Real>
Real received(const Light& light, const glm::vec<3, Real>& position, const glm::vec<3, Real>& normal) {
  using Vec = glm::vec<3, Real>;
  if (light.type == LightType::directional)
    return std::max(Real(0), glm::dot(normal, Vec(light.direction_to_light)));
  const Vec to_light = Vec(light.position) - position;
  const Real distance_squared = glm::dot(to_light, to_light);
  const Real facing = glm::dot(normal, to_light);
  if (!(facing > 0) || !(distance_squared > 0) || !(distance_squared < std::numeric_limits<Real>::infinity()))
    return 0;
  const Real distance = std::sqrt(distance_squared);
  Real value = facing / distance * falloff(light, distance_squared);
  if (light.type == LightType::spot) value *= spot_cone(light, to_light / distance);
  return value;
}

/// E(p, n) = Σ_i max(0, n·ω_i) · L_i · f_i(d_i), linear RGB, in the order of the lights.
template <typename Real>
glm::vec<3, Real> irradiance(std::span<const Light> lights, const glm::vec<3, Real>& position,
                             const glm::vec<3, Real>& normal) {
  glm::vec<3, Real> sum(0);
  for (const Light& light : lights) {
    const Real g = received(light, position, normal);
    sum += glm::vec<3, Real>(light.intensity.r, light.intensity.g, light.intensity.b) * g;
  }
  return sum;
}

}  // namespace lambake
