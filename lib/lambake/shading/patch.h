#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

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

/// The area of the patch; 0 if it is not finite or the corners are in line, to within 1e-12 of the longest
/// side.
inline double area_of(const Patch& patch) {
  const glm::dvec3 a = patch.positions[1] - patch.positions[0], b = patch.positions[2] - patch.positions[0];
  const double doubled = glm::length(glm::cross(a, b));
  const double longest = std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(b - a, b - a)});
  return std::isfinite(doubled) && doubled > 1e-12 * longest ? 0.5 * doubled : 0;
}

/// What the colours of a triangle are multiplied with and added to before they are seen, at one point or
/// over a whole triangle: P = emission + base ⊗ colour. `is_unlit` surfaces show their albedo.
struct Finish {
  glm::dvec3 base{1.0}, emission{0.0};
  bool is_unlit = false;
};

/// A linear colour as it is compared in `space`. Channels of one value, as grey light makes them, are encoded
/// once.
inline glm::dvec3 compared(const glm::dvec3& linear, ErrorSpace space) {
  const double r = compared(linear.r, space);
  const double g = linear.g == linear.r ? r : compared(linear.g, space);
  const double b = linear.b == linear.g ? g : compared(linear.b, space);
  return {r, g, b};
}

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
  for (const std::uint32_t i : lights)
    sum += to_double(all[i].intensity) * received(all[i], position, normal);
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

/// The indices of the lights that may reach the patch, ascending, in place of what `indices` holds.
inline void find_reaching_lights(std::span<const Light> lights, const Patch& patch,
                                 std::vector<std::uint32_t>& indices) {
  indices.clear();
  for (std::uint32_t i = 0; i < lights.size(); ++i)
    if (!is_unreached(lights[i], patch)) indices.push_back(i);
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

/// Appends to `out` the pieces of the part of `whole` with the given corners, cut along the chord of the
/// light's terminator: three, or the part itself where the terminator does not cross it.
inline void cut_at_terminator(const Light& light, const Patch& whole, const glm::dmat3& part,
                              std::vector<glm::dmat3>& out) {
  const Patch cut = part_of(whole, part);
  glm::dvec3 s;
  for (int c = 0; c < 3; ++c) s[c] = facing(light, cut.positions[c], cut.normals[c]);
  int alone = -1;  // The corner that is alone on its side.
  for (int c = 0; c < 3; ++c)
    if (s[c] * s[(c + 1) % 3] < 0 && s[c] * s[(c + 2) % 3] < 0) alone = c;
  if (alone < 0) {
    out.push_back(part);
    return;
  }
  const int j = (alone + 1) % 3, k = (alone + 2) % 3;
  const glm::dvec3 at_j = glm::mix(part[alone], part[j], terminator_on_edge(light, cut, alone, j));
  const glm::dvec3 at_k = glm::mix(part[alone], part[k], terminator_on_edge(light, cut, alone, k));
  out.emplace_back(part[alone], at_j, at_k);
  out.emplace_back(at_j, part[j], part[k]);
  out.emplace_back(at_j, part[k], at_k);
}

}  // namespace lambake
