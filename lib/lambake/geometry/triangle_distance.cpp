#include "lambake/geometry/triangle_distance.h"

#include <algorithm>

namespace lambake {

double distance_from_origin(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const auto to_side = [](const glm::dvec3& p, const glm::dvec3& q) {
    const glm::dvec3 d = q - p;
    const double square = glm::dot(d, d);
    const double t = square > 0 ? std::clamp(-glm::dot(p, d) / square, 0.0, 1.0) : 0;
    return glm::length(p + t * d);
  };
  const double nearest = std::min({to_side(a, b), to_side(b, c), to_side(c, a)});
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double square = glm::dot(normal, normal);
  if (!(square > 0)) return nearest;
  const glm::dvec3 foot = normal * (glm::dot(a, normal) / square);
  const auto is_inside = [&](const glm::dvec3& p, const glm::dvec3& q) {
    return glm::dot(glm::cross(q - p, foot - p), normal) >= 0;
  };
  return is_inside(a, b) && is_inside(b, c) && is_inside(c, a) ? glm::length(foot) : nearest;
}

}  // namespace lambake
