#pragma once

#include <cstddef>
#include <vector>

#include "lambake/scene/camera.h"
#include "lambake/scene/light.h"
#include "lambake/scene/material.h"
#include "lambake/scene/mesh.h"

namespace lambake {

/// All that is lit and seen, in world space: plain data. One mesh holds every triangle (placed copies
/// included); each triangle names its material.
struct Scene {
  Mesh mesh;
  std::vector<Material> materials;  ///< At least one.
  std::vector<Texture> textures;
  std::vector<Image> images;
  std::vector<Light> lights;
  std::vector<Camera> cameras;
};

/// How many of the materials that triangles are of `is_counted(m)`, m being the material's index.
template <typename IsCounted>
std::size_t count_used_materials(const Scene& scene, const IsCounted& is_counted) {
  const std::vector<bool> is_used = used_materials(scene.mesh, scene.materials.size());
  std::size_t n = 0;
  for (std::size_t m = 0; m < is_used.size(); ++m) n += is_used[m] && is_counted(m);
  return n;
}

}  // namespace lambake
