#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "lambake/render/view_transform.h"

namespace lambake {

/// Where a pixel's ray meets the plane of a triangle.
struct RayHit {
  glm::dvec2 barycentrics{0};  ///< Of the corners 1 and 2, brought into the triangle.
  double depth = 0;            ///< Distance along the view axis.
};

/// Möller and Trumbore (1997), in double. The pixel's centre may lie outside of the true triangle by the
/// rounding to the subpixel grid, so the weights are brought into it; a triangle seen exactly edge-on has
/// none, and its centroid is taken.
inline RayHit hit_triangle(const PixelRay& ray, const glm::vec3& p0, const glm::vec3& p1,
                           const glm::vec3& p2) {
  const glm::dvec3 e1 = glm::dvec3(p1) - glm::dvec3(p0), e2 = glm::dvec3(p2) - glm::dvec3(p0);
  const glm::dvec3 s = ray.origin - glm::dvec3(p0);
  const glm::dvec3 h = glm::cross(ray.direction, e2), q = glm::cross(s, e1);
  const double per_determinant = 1 / glm::dot(e1, h);
  glm::dvec2 b(glm::dot(s, h) * per_determinant, glm::dot(ray.direction, q) * per_determinant);
  if (b.x >= 0 && b.y >= 0 && b.x + b.y <= 1) return {b, glm::dot(e2, q) * per_determinant};
  const double sum = std::max(0.0, 1 - b.x - b.y) + std::max(0.0, b.x) + std::max(0.0, b.y);
  b = glm::max(b, glm::dvec2(0)) / sum;
  if (!std::isfinite(b.x) || !std::isfinite(b.y)) b = glm::dvec2(1.0 / 3.0);
  const glm::dvec3 from_origin = b.x * e1 + b.y * e2 - s;
  return {b, glm::dot(from_origin, ray.direction) / glm::dot(ray.direction, ray.direction)};
}

}  // namespace lambake
