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
/// their place on the screen.
class ViewTransform {
 public:
  ViewTransform(const Camera& camera, std::uint32_t width, std::uint32_t height)
      : is_perspective_(camera.projection == Projection::perspective),
        half_width_(0.5 * width),
        half_height_(0.5 * height),
        world_from_camera_(camera.world_from_camera) {
    const double half_view =
        is_perspective_ ? std::tan(0.5 * double(camera.vertical_fov_rad)) : double(camera.half_height);
    pixels_per_unit_ = half_height_ / half_view;
    eye_ = glm::dvec3(world_from_camera_[3]);
    camera_from_world_ = glm::inverse(glm::dmat3(world_from_camera_));
  }

  bool is_perspective() const { return is_perspective_; }

  ClipPoint clip_point(const glm::vec3& world) const {
    const glm::dvec3 p = camera_from_world_ * (glm::dvec3(world) - eye_);
    const double depth = -p.z;
    const double w = is_perspective_ ? depth : 1.0;
    return {pixels_per_unit_ * p.x + half_width_ * w, half_height_ * w - pixels_per_unit_ * p.y, w, depth};
  }

  PixelRay pixel_ray(std::uint32_t x, std::uint32_t y) const {
    const double right = (x + 0.5 - half_width_) / pixels_per_unit_;
    const double up = (half_height_ - (y + 0.5)) / pixels_per_unit_;
    const glm::dvec3 forward = -glm::dvec3(world_from_camera_[2]);
    const glm::dvec3 across =
        right * glm::dvec3(world_from_camera_[0]) + up * glm::dvec3(world_from_camera_[1]);
    return is_perspective_ ? PixelRay{eye_, across + forward} : PixelRay{eye_ + across, forward};
  }

 private:
  bool is_perspective_;
  double half_width_, half_height_, pixels_per_unit_ = 1;
  glm::dmat4 world_from_camera_;
  glm::dvec3 eye_{0};
  glm::dmat3 camera_from_world_{1};
};

}  // namespace lambake
