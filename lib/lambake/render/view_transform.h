#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

#include "lambake/scene/camera.h"

namespace lambake {

/// A point as the camera sees it, homogeneous: it lies at pixel (x/w, y/w), y downwards, pixel centres at
/// halves. All four are linear in the world position. w is the depth for perspective, 1 for orthographic.
struct ClipPoint {
  double x = 0, y = 0, w = 1;
  double depth = 0;  ///< Distance along the view axis; negative behind the eye.
};

/// The ray through a pixel's centre, in world space: origin + depth·direction.
struct PixelRay {
  glm::dvec3 origin{0}, direction{0};
};

/// How a camera maps the world to a picture of W×H pixels, in double: positions far from the origin keep
/// their place on the screen. The vector forms (screen.cpp, pixel_hits.cpp) do the same operations.
struct ViewTransform {
  bool is_perspective;
  double half_width, half_height;           ///< Of the picture, in pixels.
  double pixels_per_unit, units_per_pixel;  ///< At depth 1 for perspective.
  glm::dvec3 eye, right, up, forward;
  glm::dmat3 camera_from_world;  ///< Of directions.

  ViewTransform(const Camera& camera, std::uint32_t width, std::uint32_t height)
      : is_perspective(camera.projection == Projection::perspective),
        half_width(0.5 * width),
        half_height(0.5 * height) {
    const glm::dmat4 world_from_camera(camera.world_from_camera);
    const double half_view =
        is_perspective ? std::tan(0.5 * double(camera.vertical_fov_rad)) : double(camera.half_height);
    pixels_per_unit = half_height / half_view;
    units_per_pixel = half_view / half_height;
    right = glm::dvec3(world_from_camera[0]);
    up = glm::dvec3(world_from_camera[1]);
    forward = -glm::dvec3(world_from_camera[2]);
    eye = glm::dvec3(world_from_camera[3]);
    camera_from_world = glm::inverse(glm::dmat3(world_from_camera));
  }

  ClipPoint clip_point(const glm::vec3& world) const {
    const glm::dvec3 p = camera_from_world * (glm::dvec3(world) - eye);
    const double depth = -p.z;
    const double w = is_perspective ? depth : 1.0;
    return {pixels_per_unit * p.x + half_width * w, half_height * w - pixels_per_unit * p.y, w, depth};
  }

  PixelRay pixel_ray(std::uint32_t x, std::uint32_t y) const {
    const double to_right = (x + 0.5 - half_width) * units_per_pixel;
    const double upwards = (half_height - (y + 0.5)) * units_per_pixel;
    const glm::dvec3 across = to_right * right + upwards * up;
    return is_perspective ? PixelRay{eye, across + forward} : PixelRay{eye + across, forward};
  }
};

}  // namespace lambake
