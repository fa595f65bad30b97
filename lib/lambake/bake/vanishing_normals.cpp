#include "lambake/bake/vanishing_normals.h"

#include <algorithm>

#include "lambake/geometry/triangle_distance.h"

namespace lambake {
namespace {

/// In a triangle of the scene whose normal gets as short as the first of these, parts whose normals are all
/// shorter than the second have no direction.
constexpr double vanishing_normal = 0.05, short_normal = 0.25;

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
