#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <span>

namespace lambake {

/// Axis-aligned box; empty (min > max) until a point is added.
struct Bounds {
  glm::vec3 min{std::numeric_limits<float>::infinity()};
  glm::vec3 max{-std::numeric_limits<float>::infinity()};

  bool is_empty() const { return !(min.x <= max.x); }
  glm::vec3 center() const { return min * 0.5f + max * 0.5f; }
  /// Half of the diagonal: the radius of the sphere around the box.
  float radius() const { return is_empty() ? 0.0f : glm::length(max * 0.5f - min * 0.5f); }
};

inline bool is_finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Box of the finite points among `points`.
inline Bounds bounds_of(std::span<const glm::vec3> points) {
  Bounds box;
  for (const glm::vec3& p : points)
    if (is_finite(p)) box.min = glm::min(box.min, p), box.max = glm::max(box.max, p);
  return box;
}

}  // namespace lambake
