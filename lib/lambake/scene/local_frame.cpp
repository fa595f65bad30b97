#include "lambake/scene/local_frame.h"

#include <algorithm>
#include <cmath>

#include "lambake/core/bounds.h"

namespace lambake {
namespace {

/// Whether two vertices are so far apart, for their distance from the origin, that the middle of the box lies
/// within 33 of its radii: a mesh that is not far away has such near its beginning, and is not read to its
/// end.
bool is_surely_near(std::span<const glm::vec3> positions) {
  const auto first =
      std::find_if(positions.begin(), positions.end(), [](const glm::vec3& p) { return is_finite(p); });
  if (first == positions.end()) return true;
  const float away = std::max({std::abs(first->x), std::abs(first->y), std::abs(first->z)});
  return std::any_of(first, positions.end(), [&](const glm::vec3& p) {
    return is_finite(p) && 16 * glm::distance(p, *first) >= away;
  });
}

}  // namespace

LocalFrame::LocalFrame(const Scene& scene) : scene_(scene) {
  const bool reads_positions = std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& light) {
    return light.type != LightType::directional;
  });
  if (!reads_positions || is_surely_near(scene.mesh.positions)) return;
  const Bounds box = bounds_of(scene.mesh.positions);
  if (box.is_empty()) return;
  // Along an axis where the box is this far away, x and the middle are within a factor of two: x minus the
  // middle is exact (Sterbenz).
  glm::vec3 origin(0);
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(box.center()[axis]) > 64 * box.radius()) origin[axis] = box.center()[axis];
  if (origin == glm::vec3(0)) return;
  is_moved_ = true;
  positions_ = scene.mesh.positions;
  for (glm::vec3& p : positions_) p -= origin;
  lights_ = scene.lights;
  for (Light& light : lights_) light.position = glm::vec3(glm::dvec3(light.position) - glm::dvec3(origin));
}

}  // namespace lambake
