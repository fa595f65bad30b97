#include "lambake/render/screen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lambake/render/screen.cpp"
#include <hwy/foreach_target.h>  // compiles the part below once per vector path
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, 16>;
using Floats = hn::Rebind<float, Doubles>;
using Ints = hn::Rebind<std::int32_t, Doubles>;
using V = hn::Vec<Doubles>;

/// One vertex in each lane. The operations are those of ViewTransform::clip_point() and snapped(), in their
/// order.
HWY_INLINE void project_lanes(const Screen& screen, const glm::vec3* world, ScreenVertex* out) {
  const Doubles d;
  const Floats f;
  const Ints i32;
  const ViewTransform& view = screen.view;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0);
  hn::Vec<Floats> wx, wy, wz;
  hn::LoadInterleaved3(f, &world->x, wx, wy, wz);
  const V px = hn::PromoteTo(d, wx), py = hn::PromoteTo(d, wy), pz = hn::PromoteTo(d, wz);
  const auto is_finite = hn::And(hn::And(hn::Eq(hn::Sub(px, px), zero), hn::Eq(hn::Sub(py, py), zero)),
                                 hn::Eq(hn::Sub(pz, pz), zero));
  const V dx = hn::Sub(px, hn::Set(d, view.eye.x)), dy = hn::Sub(py, hn::Set(d, view.eye.y)),
          dz = hn::Sub(pz, hn::Set(d, view.eye.z));
  const auto along = [&](int axis) {
    const glm::dmat3& m = view.camera_from_world;
    return hn::Add(hn::Add(hn::Mul(hn::Set(d, m[0][axis]), dx), hn::Mul(hn::Set(d, m[1][axis]), dy)),
                   hn::Mul(hn::Set(d, m[2][axis]), dz));
  };
  const V depth = hn::Neg(along(2));
  const V w = view.is_perspective ? depth : one;
  const V scale = hn::Set(d, view.pixels_per_unit);
  const V x = hn::Add(hn::Mul(scale, along(0)), hn::Mul(hn::Set(d, view.half_width), w));
  const V y = hn::Sub(hn::Mul(hn::Set(d, view.half_height), w), hn::Mul(scale, along(1)));

  const V right = hn::Mul(hn::Set(d, screen.width), w), bottom = hn::Mul(hn::Set(d, screen.height), w);
  const V guard = hn::Mul(hn::Set(d, guard_band_pixels), w);
  V outcode = zero;
  const auto mark = [&](auto mask, Outcode bit) {
    outcode = hn::Add(outcode, hn::IfThenElseZero(mask, hn::Set(d, static_cast<double>(bit))));
  };
  mark(hn::Lt(x, zero), left_of_picture);
  mark(hn::Gt(x, right), right_of_picture);
  mark(hn::Lt(y, zero), above_picture);
  mark(hn::Gt(y, bottom), below_picture);
  const auto is_near = hn::Lt(depth, hn::Set(d, screen.near)), is_far = hn::Gt(depth, hn::Set(d, screen.far));
  mark(is_near, too_near);
  mark(is_far, too_far);
  const auto is_beyond = hn::Or(hn::Or(hn::Lt(x, hn::Neg(guard)), hn::Gt(x, hn::Add(right, guard))),
                                hn::Or(hn::Lt(y, hn::Neg(guard)), hn::Gt(y, hn::Add(bottom, guard))));
  mark(is_beyond, beyond_guard_band);
  outcode = hn::IfThenElse(is_finite, outcode, hn::Set(d, static_cast<double>(not_finite)));

  const auto has_place = hn::AndNot(hn::Or(hn::Or(is_near, is_far), is_beyond), is_finite);
  const V half = hn::Set(d, 0.5), fine = hn::Set(d, static_cast<double>(subpixels));
  const auto snap = [&](V v) {
    return hn::IfThenElseZero(has_place, hn::Floor(hn::Add(hn::Mul(hn::Div(v, w), fine), half)));
  };
  const V nearness =
      hn::IfThenElseZero(has_place, view.is_perspective ? hn::Div(one, depth) : hn::Neg(depth));
  hn::StoreInterleaved4(hn::DemoteTo(i32, snap(x)), hn::DemoteTo(i32, snap(y)),
                        hn::BitCast(i32, hn::DemoteTo(f, nearness)), hn::DemoteTo(i32, outcode), i32,
                        &out->x);
}

void project(const Screen& screen, const glm::vec3* world, std::size_t n, ScreenVertex* out) {
  const std::size_t lanes = hn::Lanes(Doubles());
  std::size_t i = 0;
  for (; i + lanes <= n; i += lanes) project_lanes(screen, world + i, out + i);
  if (i == n) return;
  std::array<glm::vec3, hn::MaxLanes(Doubles())> last_world{};
  std::array<ScreenVertex, hn::MaxLanes(Doubles())> last_out;
  std::copy(world + i, world + n, last_world.begin());
  project_lanes(screen, last_world.data(), last_out.data());
  std::copy_n(last_out.begin(), n - i, out + i);
}

}  // namespace
}  // namespace lambake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lambake {

static_assert(sizeof(glm::vec3) == 3 * sizeof(float) && sizeof(ScreenVertex) == 4 * sizeof(std::int32_t));

namespace {
HWY_EXPORT(project);

/// The point where the plane is met between a point inside (distance >= 0) and one outside (< 0).
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

ScreenVertex snapped(const ViewTransform& view, const ClipPoint& point) {
  ScreenVertex v{};
  v.x = static_cast<std::int32_t>(std::floor(point.x / point.w * subpixels + 0.5));
  v.y = static_cast<std::int32_t>(std::floor(point.y / point.w * subpixels + 0.5));
  v.nearness = static_cast<float>(view.is_perspective ? 1 / point.depth : -point.depth);
  return v;
}

}  // namespace

Screen::Screen(const Camera& camera, std::uint32_t picture_width, std::uint32_t picture_height)
    : view(camera, picture_width, picture_height),
      near(camera.near_distance),
      far(camera.far_distance > 0 ? double(camera.far_distance) : std::numeric_limits<double>::infinity()),
      width(picture_width),
      height(picture_height) {}

void project_vertices(const Screen& screen, std::span<const glm::vec3> world, std::span<ScreenVertex> out) {
  HWY_DYNAMIC_DISPATCH(project)(screen, world.data(), world.size(), out.data());
}

void clip_triangle(const Screen& screen, const glm::vec3 (&world)[3], std::vector<ScreenTriangle>& pieces) {
  const ViewTransform& view = screen.view;
  std::vector<ClipPoint> polygon{view.clip_point(world[0]), view.clip_point(world[1]),
                                 view.clip_point(world[2])};
  std::vector<ClipPoint> scratch;
  const double near = screen.near, far = screen.far, guard = guard_band_pixels;
  clip_polygon(polygon, scratch, [&](const ClipPoint& p) { return p.depth - near; });
  if (std::isfinite(far)) clip_polygon(polygon, scratch, [&](const ClipPoint& p) { return far - p.depth; });
  clip_polygon(polygon, scratch, [&](const ClipPoint& p) { return p.x + guard * p.w; });
  clip_polygon(polygon, scratch, [&](const ClipPoint& p) { return (screen.width + guard) * p.w - p.x; });
  clip_polygon(polygon, scratch, [&](const ClipPoint& p) { return p.y + guard * p.w; });
  clip_polygon(polygon, scratch, [&](const ClipPoint& p) { return (screen.height + guard) * p.w - p.y; });
  for (std::size_t i = 2; i < polygon.size(); ++i)
    pieces.push_back({{snapped(view, polygon[0]), snapped(view, polygon[i - 1]), snapped(view, polygon[i])}});
}

}  // namespace lambake
#endif  // HWY_ONCE
