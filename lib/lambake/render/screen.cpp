#include "lambake/render/screen.h"

#include <array>
#include <cmath>
#include <limits>

#include "lambake/core/bounds.h"

namespace lambake {
namespace {

/// The point where the plane is met between a point inside (distance > = 0) and one outside (< 0).
ClipPoint between(const ClipPoint& inside, double distance_inside, const ClipPoint& outside,
                  double distance_outside) {
  const double t = distance_inside / (distance_inside - distance_outside);
  const auto mix = [t](double a, double b) { return a + t * (b - a); };
  return {mix(inside.x, outside.x), mix(inside.y, outside.y), mix(inside.w, outside.w),
          mix(inside.depth, outside.depth)};
}

/// One step of Sutherland and Hodgman (1974): the part of a convex polygon where `distance` is >= 0. The
/// point on an edge is always computed from its inside end, so that both polygons at the edge get the same.
template <typename Distance>
void clip_polygon(std::vector<ClipPoint>& polygon, std::vector<ClipPoint>& scratch,
                  const Distance& distance) {
  scratch.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const ClipPoint &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double da = distance(a), db = distance(b);
    if (da >= 0) scratch.push_back(a);
    if (da >= 0 && db < 0) scratch.push_back(between(a, da, b, db));
    if (da < 0 && db >= 0) scratch.push_back(between(b, db, a, da));
  }
  polygon.swap(scratch);
}

}  // namespace

Screen::Screen(const Camera& camera, std::uint32_t width, std::uint32_t height)
    : view_(camera, width, height),
      near_(camera.near_distance),
      far_(camera.far_distance > 0 ? double(camera.far_distance) : std::numeric_limits<double>::infinity()),
      width_(width),
      height_(height) {}

ScreenVertex Screen::snapped(const ClipPoint& point) const {
  ScreenVertex v;
  v.x = static_cast<std::int32_t>(std::floor(point.x / point.w * subpixels + 0.5));
  v.y = static_cast<std::int32_t>(std::floor(point.y / point.w * subpixels + 0.5));
  v.nearness = static_cast<float>(view_.is_perspective ? 1 / point.depth : -point.depth);
  return v;
}

ScreenVertex Screen::vertex(const glm::vec3& world) const {
  ScreenVertex v;
  if (!is_finite(world)) {
    v.outcode = not_finite;
    return v;
  }
  const ClipPoint p = view_.clip_point(world);
  std::uint32_t outcode = 0;
  if (p.x < 0) outcode |= left_of_picture;
  if (p.x > width_ * p.w) outcode |= right_of_picture;
  if (p.y < 0) outcode |= above_picture;
  if (p.y > height_ * p.w) outcode |= below_picture;
  if (p.depth < near_) outcode |= too_near;
  if (p.depth > far_) outcode |= too_far;
  const double guard = guard_band_pixels * p.w;
  if (p.x < -guard || p.x > width_ * p.w + guard || p.y < -guard || p.y > height_ * p.w + guard)
    outcode |= beyond_guard_band;
  if ((outcode & clipped_if_any) == 0) v = snapped(p);
  v.outcode = outcode;
  return v;
}

void Screen::clip(const glm::vec3 (&world)[3], std::vector<ScreenTriangle>& pieces) const {
  std::vector<ClipPoint> polygon{view_.clip_point(world[0]), view_.clip_point(world[1]),
                                 view_.clip_point(world[2])};
  std::vector<ClipPoint> scratch;
  const double guard = guard_band_pixels;
  clip_polygon(polygon, scratch, [&](const ClipPoint& p) { return p.depth - near_; });
  if (std::isfinite(far_)) clip_polygon(polygon, scratch, [&](const ClipPoint& p) { return far_ - p.depth; });
  clip_polygon(polygon, scratch, [&](const ClipPoint& p) { return p.x + guard * p.w; });
  clip_polygon(polygon, scratch, [&](const ClipPoint& p) { return (width_ + guard) * p.w - p.x; });
  clip_polygon(polygon, scratch, [&](const ClipPoint& p) { return p.y + guard * p.w; });
  clip_polygon(polygon, scratch, [&](const ClipPoint& p) { return (height_ + guard) * p.w - p.y; });
  for (std::size_t i = 2; i < polygon.size(); ++i)
    pieces.push_back({{snapped(polygon[0]), snapped(polygon[i - 1]), snapped(polygon[i])}});
}

}  // namespace lambake
