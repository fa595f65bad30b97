#pragma once

#include <glm/glm.hpp>
#include <string>

namespace lambake {

enum class Projection { perspective, orthographic };

/// A camera: looks along −z of its own space, y up, as glTF has it.
struct Camera {
  std::string name;
  Projection projection = Projection::perspective;
  glm::mat4 world_from_camera{1.0f};  ///< Rigid.
  float vertical_fov_rad = 0.6f;      ///< perspective: full angle, in (0, π).
  float half_height = 1;              ///< orthographic: half the height of the view, > 0.
  float near_distance = 0.01f;        ///< > 0 for perspective.
  float far_distance = 0;             ///< Farther is not drawn; 0 is none.
};

}  // namespace lambake
