#include "lambake/render/framing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "lambake/core/bounds.h"
#include "lambake/core/error.h"

namespace lambake {
namespace {

constexpr float default_vertical_fov_rad = 0.6f;
/// Share of the distance to what is looked at. Depths are compared as reciprocals, so a near plane close to
/// the eye costs no precision.
constexpr double near_share = 1e-4;

/// Columns: the model's axes to the right, up and to the front.
glm::dmat3 axes_of(Up up) {
  return up == Up::y ? glm::dmat3(1)
                     : glm::dmat3(glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1), glm::dvec3(0, -1, 0));
}

/// Camera at `eye` that looks along `forward` (unit).
Camera aim(const glm::dvec3& eye, const glm::dvec3& forward, double distance, float vertical_fov_rad,
           const glm::dmat3& axes) {
  // Straight down or up as from an eye that is a little to the front of what it sees.
  const double rise = glm::dot(forward, axes[1]);
  const glm::dvec3 up = std::abs(rise) <= 0.9999 ? axes[1] : rise < 0 ? -axes[2] : axes[2];
  const glm::dvec3 right = glm::normalize(glm::cross(forward, up));
  Camera camera;
  camera.vertical_fov_rad = vertical_fov_rad;
  camera.near_distance = static_cast<float>(distance * near_share);
  camera.world_from_camera =
      glm::mat4(glm::dmat4(glm::dvec4(right, 0), glm::dvec4(glm::cross(right, forward), 0),
                           glm::dvec4(-forward, 0), glm::dvec4(eye, 1)));
  return camera;
}

/// The sphere that must be in the picture.
struct Sphere {
  glm::dvec3 center{0};
  double radius = 1;
};

Sphere sphere_around(std::span<const glm::vec3> points) {
  const Bounds box = bounds_of(points);
  if (box.is_empty()) return {};
  Sphere sphere{glm::dvec3(box.center()), 0};
  for (const glm::vec3& p : points)
    if (is_finite(p)) sphere.radius = std::max(sphere.radius, glm::length(glm::dvec3(p) - sphere.center));
  if (!(sphere.radius > 0)) sphere.radius = 1;
  return sphere;
}

Camera frame_from(const Sphere& sphere, float aspect, double turn_rad, Up up) {
  const double half_height = std::tan(0.5 * double(default_vertical_fov_rad));
  const double half_angle = std::atan(half_height * std::min(1.0, double(aspect)));
  constexpr double margin = 1.02;  // a little air, and more than what rounding of the eye to float takes
  const double distance = margin * sphere.radius / std::sin(half_angle);
  const double turn = 0.5 + turn_rad;
  const glm::dmat3 axes = axes_of(up);
  const glm::dvec3 towards_eye = axes * glm::normalize(glm::dvec3(std::sin(turn), 0.35, std::cos(turn)));
  if (!is_finite(glm::vec3(sphere.center + distance * towards_eye)))
    throw InvalidScene(
        fmt::format("camera: expected a model that float can see from outside, found one of radius {:.3g}",
                    sphere.radius));
  return aim(sphere.center + distance * towards_eye, -towards_eye, distance, default_vertical_fov_rad, axes);
}

}  // namespace

Camera frame(std::span<const glm::vec3> points, float aspect, Up up) {
  return frame_from(sphere_around(points), aspect, 0, up);
}

std::vector<Camera> frame_around(std::span<const glm::vec3> points, float aspect, std::size_t n_views,
                                 Up up) {
  const Sphere sphere = sphere_around(points);
  std::vector<Camera> cameras;
  for (std::size_t i = 0; i < n_views; ++i)
    cameras.push_back(frame_from(
        sphere, aspect, glm::two_pi<double>() * static_cast<double>(i) / static_cast<double>(n_views), up));
  return cameras;
}

Camera look_at(const glm::vec3& eye, const glm::vec3& target, float vertical_fov_rad, Up up) {
  if (!(vertical_fov_rad > 0 && vertical_fov_rad < glm::pi<float>()))
    throw InvalidOption(fmt::format("camera: expected an angle between 0 and 180 degrees, found {}",
                                    double(vertical_fov_rad) * 180 / glm::pi<double>()));
  const glm::dvec3 offset = glm::dvec3(target) - glm::dvec3(eye);
  const double distance = glm::length(offset);
  if (!(distance > 0) || !std::isfinite(distance))
    throw InvalidOption("camera: eye and target must be finite and differ");
  return aim(glm::dvec3(eye), offset / distance, distance, vertical_fov_rad, axes_of(up));
}

}  // namespace lambake
