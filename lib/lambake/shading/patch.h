#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "lambake/core/color.h"
#include "lambake/shading/lambert.h"

namespace lambake {

/// What is linear over a triangle, in double: column i of a matrix belongs to corner i, so that
/// `positions * b` is the position at the barycentrics b. A part of a triangle is again a Patch, with the
/// interpolated values of the whole one at its corners (normals as interpolated: their length counts).
struct Patch {
  glm::dmat3 positions{0.0}, normals{0.0};
  glm::dmat3 albedos{1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};  ///< Vertex base colours.
  glm::dmat3 colors{0.0};                                           ///< The baked colours.
};

/// The part of `whole` whose corners are at the barycentrics that are the columns of `corners`.
inline Patch part_of(const Patch& whole, const glm::dmat3& corners) {
  return {whole.positions * corners, whole.normals * corners, whole.albedos * corners,
          whole.colors * corners};
}

/// What the colours of a triangle are multiplied with and added to before they are seen, at one point or
/// over a whole triangle: P = emission + base ⊗ colour. `is_unlit` surfaces show their albedo.
struct Finish {
  glm::dvec3 base{1.0}, emission{0.0};
  bool is_unlit = false;
};

/// The reference at `b`: vertex base colour ⊗ E with the normal interpolated and renormalised (no light
/// where it vanishes), summed over the lights with the indices `lights`.
inline glm::dvec3 reference_at(const Patch& patch, std::span<const Light> all,
                               std::span<const std::uint32_t> lights, bool is_unlit, const glm::dvec3& b) {
  const glm::dvec3 albedo = patch.albedos * b;
  if (is_unlit) return albedo;
  const glm::dvec3 position = patch.positions * b;
  glm::dvec3 normal = patch.normals * b;
  const double length = glm::length(normal);
  if (!(length > 0)) return glm::dvec3(0);
  normal /= length;
  glm::dvec3 sum(0);
  for (const std::uint32_t i : lights) {
    const LinearRgb& intensity = all[i].intensity;
    sum += glm::dvec3(intensity.r, intensity.g, intensity.b) * received(all[i], position, normal);
  }
  return albedo * sum;
}

/// n·(p_i − p) for a positional light, n·ω for a directional one, before normalisation: its sign tells on
/// which side of the terminator a corner of the patch is.
inline double facing(const Light& light, const glm::dvec3& position, const glm::dvec3& normal) {
  return light.type == LightType::directional ? glm::dot(normal, glm::dvec3(light.direction_to_light))
                                              : glm::dot(normal, glm::dvec3(light.position) - position);
}

/// Whether `light` gives nothing anywhere on the patch: the coefficients of N·(p_i − p) in the Bernstein
/// basis are all at most 0, or the sphere of its range misses the patch's box.
inline bool is_unreached(const Light& light, const Patch& patch) {
  if (light.type != LightType::directional && light.range > 0) {
    const glm::dvec3 low = glm::min(patch.positions[0], glm::min(patch.positions[1], patch.positions[2]));
    const glm::dvec3 high = glm::max(patch.positions[0], glm::max(patch.positions[1], patch.positions[2]));
    const glm::dvec3 center(light.position);
    const glm::dvec3 gap = glm::max(glm::max(low - center, center - high), glm::dvec3(0));
    if (glm::length(gap) >= light.range) return true;
  }
  for (int i = 0; i < 3; ++i)
    if (facing(light, patch.positions[i], patch.normals[i]) > 0) return false;
  if (light.type == LightType::directional) return true;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    if (facing(light, patch.positions[i], patch.normals[j]) +
            facing(light, patch.positions[j], patch.normals[i]) >
        0)
      return false;
  }
  return true;
}

/// Where N·(p_i − p) is 0 between corner i (t = 0) and corner j (t = 1) of the patch, whose values there have
/// opposite signs. The root of the quadratic with Bernstein coefficients s0, s01, s1; a straight line for a
/// directional light.
inline double terminator_on_edge(const Light& light, const Patch& patch, int i, int j) {
  const double s0 = facing(light, patch.positions[i], patch.normals[i]);
  const double s1 = facing(light, patch.positions[j], patch.normals[j]);
  const double s01 = 0.5 * (facing(light, patch.positions[i], patch.normals[j]) +
                            facing(light, patch.positions[j], patch.normals[i]));
  const double root = std::sqrt(std::max(0.0, s01 * s01 - s0 * s1));
  return std::clamp(s0 / (s0 - s01 + std::copysign(root, s0)), 0.0, 1.0);
}

}  // namespace lambake
