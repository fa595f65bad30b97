#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "lambake/scene/scene.h"

namespace lambake {

/// The vertices and lights of a scene as light *between* the vertices needs them. Far from the origin float
/// leaves few steps for what is interpolated: at 2^20 extents one step is an eighth of the mesh. There, both
/// are moved near the origin; what float holds of the positions stays exact. Nothing is moved, or copied,
/// where all lights are directional (no position is read) or the mesh is within 64 radii of the origin.
///
/// O(V) where it moves them, else a few vertices are read. The scene must outlive it.
class LocalFrame {
 public:
  explicit LocalFrame(const Scene& scene);
  LocalFrame(const LocalFrame&) = delete;
  LocalFrame& operator=(const LocalFrame&) = delete;

  const std::vector<glm::vec3>& positions() const { return is_moved_ ? positions_ : scene_.mesh.positions; }
  std::span<const Light> lights() const { return is_moved_ ? lights_ : scene_.lights; }

 private:
  const Scene& scene_;
  bool is_moved_ = false;
  std::vector<glm::vec3> positions_;
  std::vector<Light> lights_;
};

}  // namespace lambake
