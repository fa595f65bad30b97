#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "lambake/scene/camera.h"

namespace lambake {

/// Which axis of the model points up: y as in glTF, where the front is +z, or z as in CAD and on maps, where
/// it is −y.
enum class Up { y, z };

/// A camera that sees all finite `points`, in a sphere around the middle of their box, from a little above
/// and to the right, for a picture of the given aspect (width / height).
/// @throws InvalidScene if float has no place for it: points near float's largest.
Camera frame(std::span<const glm::vec3> points, float aspect, Up up = Up::y);

/// `n_views` such cameras evenly around the model; the first is frame(). Errors as of frame().
std::vector<Camera> frame_around(std::span<const glm::vec3> points, float aspect, std::size_t n_views,
                                 Up up = Up::y);

/// A perspective camera at `eye` looking at `target`. Where it looks straight down, the front is at the
/// bottom of its picture; straight up, at the top.
/// @throws InvalidOption if eye and target are equal or not finite, or the angle is not in (0, π).
Camera look_at(const glm::vec3& eye, const glm::vec3& target, float vertical_fov_rad, Up up = Up::y);

}  // namespace lambake
