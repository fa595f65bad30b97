#include "lambake/bake/vanishing_normals.h"

#include <algorithm>

namespace lambake {
namespace {

/// In a triangle of the scene whose normal gets as short as the first of these, parts whose normals are all
/// shorter than the second have no direction.
constexpr double vanishing_normal = 0.05, short_normal = 0.25;

/// The distance of the triangle a b c from the origin.
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

}  // namespace

bool has_direction(const CutMesh& cut, const Mesh& whole, std::size_t triangle) {
  const glm::uvec3& part = cut.mesh().triangles[triangle];
  const auto length = [&](int c) { return glm::length(cut.normals()[part[c]]); };
  if (std::max({length(0), length(1), length(2)}) >= short_normal) return true;
  const glm::uvec3& t = whole.triangles[cut.parent_triangles()[triangle]];
  const auto normal = [&](int c) { return glm::dvec3(whole.normals[t[c]]); };
  return distance_from_origin(normal(0), normal(1), normal(2)) > vanishing_normal;
}

}  // namespace lambake
