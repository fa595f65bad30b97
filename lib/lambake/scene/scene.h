#pragma once

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

}  // namespace lambake
