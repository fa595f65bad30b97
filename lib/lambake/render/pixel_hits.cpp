#include "lambake/render/pixel_hits.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lambake/render/visibility.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lambake/render/pixel_hits.cpp"
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
using Indices = hn::Vec<Ints>;

/// One point in each lane.
struct V3 {
  V x, y, z;
};

V3 broadcast(const glm::dvec3& v) {
  const Doubles d;
  return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}

HWY_INLINE V3 add(const V3& a, const V3& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}

HWY_INLINE V3 subtract(const V3& a, const V3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

HWY_INLINE V3 scale(V s, const V3& v) {
  return {hn::Mul(s, v.x), hn::Mul(s, v.y), hn::Mul(s, v.z)};
}

/// In glm's order of operations, as the scalar form.
HWY_INLINE V dot(const V3& a, const V3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

HWY_INLINE V3 cross(const V3& a, const V3& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(b.y, a.z)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(b.z, a.x)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(b.x, a.y))};
}

/// Corners of the triangles in the lanes, in single precision as they are stored.
struct Corners {
  hn::Vec<Floats> p[3][3];  ///< Corner, axis.

  V3 point(int corner) const {
    const Doubles d;
    return {hn::PromoteTo(d, p[corner][0]), hn::PromoteTo(d, p[corner][1]), hn::PromoteTo(d, p[corner][2])};
  }
};

HWY_INLINE Corners gather_corners(const Mesh& mesh, Indices triangle) {
  const Floats f;
  const Ints i32;
  const Indices three = hn::Set(i32, 3), first = hn::Mul(triangle, three);
  const std::int32_t* const corner_of = reinterpret_cast<const std::int32_t*>(mesh.triangles.data());
  const float* const positions = &mesh.positions.data()->x;
  Corners corners;
  for (int c = 0; c < 3; ++c) {
    const Indices at = hn::Mul(hn::GatherIndex(i32, corner_of + c, first), three);
    for (int axis = 0; axis < 3; ++axis) corners.p[c][axis] = hn::GatherIndex(f, positions + axis, at);
  }
  return corners;
}

/// The same where neighbours share triangles: each is loaded once and spread over its lanes.
HWY_INLINE Corners spread_corners(const Mesh& mesh, Indices triangle, const std::uint32_t* triangles) {
  const Floats f;
  const Ints i32;
  Corners corners;
  for (auto& corner : corners.p)
    for (auto& axis : corner) axis = hn::Zero(f);
  for (std::size_t lane = 0; lane < hn::Lanes(f);) {
    const std::uint32_t t = triangles[lane];
    if (t != no_triangle) {
      const auto mask = hn::RebindMask(f, hn::Eq(triangle, hn::Set(i32, static_cast<std::int32_t>(t))));
      for (int c = 0; c < 3; ++c) {
        const glm::vec3& p = mesh.positions[mesh.triangles[t][c]];
        for (int axis = 0; axis < 3; ++axis)
          corners.p[c][axis] = hn::IfThenElse(mask, hn::Set(f, p[axis]), corners.p[c][axis]);
      }
    }
    do ++lane;
    while (lane < hn::Lanes(f) && triangles[lane] == t);
  }
  return corners;
}

void hit_pixels(const Mesh& mesh, const ViewTransform& view, std::uint32_t x, std::uint32_t y,
                const std::uint32_t* triangles, std::size_t n, glm::vec2* barycentrics, float* depths) {
  const Doubles d;
  const Floats f;
  const Ints i32;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0);
  const auto nowhere = hn::Set(f, std::numeric_limits<float>::infinity());
  const double upwards = (view.half_height - (y + 0.5)) * view.units_per_pixel;
  const V3 eye = broadcast(view.eye), right = broadcast(view.right), forward = broadcast(view.forward);
  const V3 up = broadcast(upwards * view.up);
  const std::size_t lanes = hn::Lanes(d);
  const std::size_t few_changes = lanes / 2;

  for (std::size_t begin = 0; begin < n; begin += lanes) {
    const std::int32_t* const row = reinterpret_cast<const std::int32_t*>(triangles) + begin;
    const Indices triangle = hn::LoadU(i32, row);
    const auto is_covered = hn::Gt(triangle, hn::Set(i32, -1));  // no_triangle is −1
    if (hn::AllFalse(i32, is_covered)) {
      hn::StoreInterleaved2(hn::Zero(f), hn::Zero(f), f, &barycentrics[begin].x);
      hn::StoreU(nowhere, f, depths + begin);
      continue;
    }
    const std::size_t n_changes = hn::CountTrue(i32, hn::Ne(triangle, hn::LoadU(i32, row + 1)));
    const Corners corners = n_changes <= few_changes
                                ? spread_corners(mesh, triangle, triangles + begin)
                                : gather_corners(mesh, hn::IfThenElseZero(is_covered, triangle));
    const V3 p0 = corners.point(0), p1 = corners.point(1), p2 = corners.point(2);

    const V pixel = hn::Add(hn::Iota(d, static_cast<double>(x + begin)), hn::Set(d, 0.5));
    const V to_right = hn::Mul(hn::Sub(pixel, hn::Set(d, view.half_width)), hn::Set(d, view.units_per_pixel));
    const V3 across = add(scale(to_right, right), up);
    const V3 origin = view.is_perspective ? eye : add(eye, across);
    const V3 direction = view.is_perspective ? add(across, forward) : forward;

    const V3 e1 = subtract(p1, p0), e2 = subtract(p2, p0), s = subtract(origin, p0);
    const V3 h = cross(direction, e2), q = cross(s, e1);
    const V per_determinant = hn::Div(one, dot(e1, h));
    V b1 = hn::Mul(dot(s, h), per_determinant), b2 = hn::Mul(dot(direction, q), per_determinant);
    V depth = hn::Mul(dot(e2, q), per_determinant);

    const auto is_inside = hn::And(hn::And(hn::Ge(b1, zero), hn::Ge(b2, zero)), hn::Le(hn::Add(b1, b2), one));
    if (!hn::AllTrue(d, is_inside)) {
      const V b0 = hn::Max(zero, hn::Sub(hn::Sub(one, b1), b2));
      const V at_least_1 = hn::Max(zero, b1), at_least_2 = hn::Max(zero, b2);
      const V sum = hn::Add(hn::Add(b0, at_least_1), at_least_2);
      const V third = hn::Set(d, 1.0 / 3.0);
      V c1 = hn::Div(at_least_1, sum), c2 = hn::Div(at_least_2, sum);
      // A NaN or an infinity minus itself is not 0.
      const auto is_finite = hn::And(hn::Eq(hn::Sub(b1, b1), zero), hn::Eq(hn::Sub(b2, b2), zero));
      c1 = hn::IfThenElse(is_finite, c1, third);
      c2 = hn::IfThenElse(is_finite, c2, third);
      const V3 from_origin = subtract(add(scale(c1, e1), scale(c2, e2)), s);
      const V clamped_depth = hn::Div(dot(from_origin, direction), dot(direction, direction));
      b1 = hn::IfThenElse(is_inside, b1, c1);
      b2 = hn::IfThenElse(is_inside, b2, c2);
      depth = hn::IfThenElse(is_inside, depth, clamped_depth);
    }

    const auto keep = hn::RebindMask(f, is_covered);
    const auto w1 = hn::IfThenElseZero(keep, hn::DemoteTo(f, b1));
    const auto w2 = hn::IfThenElseZero(keep, hn::DemoteTo(f, b2));
    hn::StoreInterleaved2(w1, w2, f, &barycentrics[begin].x);
    hn::StoreU(hn::IfThenElse(keep, hn::DemoteTo(f, depth), nowhere), f, depths + begin);
  }
}

}  // namespace
}  // namespace lambake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lambake {

static_assert(sizeof(glm::vec3) == 3 * sizeof(float) && sizeof(glm::uvec3) == 3 * sizeof(std::int32_t));

namespace {
HWY_EXPORT(hit_pixels);
}  // namespace

RayHit hit_triangle(const PixelRay& ray, const glm::vec3& p0, const glm::vec3& p1, const glm::vec3& p2) {
  const glm::dvec3 e1 = glm::dvec3(p1) - glm::dvec3(p0), e2 = glm::dvec3(p2) - glm::dvec3(p0);
  const glm::dvec3 s = ray.origin - glm::dvec3(p0);
  const glm::dvec3 h = glm::cross(ray.direction, e2), q = glm::cross(s, e1);
  const double per_determinant = 1 / glm::dot(e1, h);
  glm::dvec2 b(glm::dot(s, h) * per_determinant, glm::dot(ray.direction, q) * per_determinant);
  if (b.x >= 0 && b.y >= 0 && b.x + b.y <= 1) return {b, glm::dot(e2, q) * per_determinant};
  if (std::isfinite(b.x) && std::isfinite(b.y)) {
    const double b0 = std::max(0.0, 1 - b.x - b.y);
    b = glm::max(b, glm::dvec2(0));
    b /= b0 + b.x + b.y;
  } else {
    b = glm::dvec2(1.0 / 3.0);
  }
  const glm::dvec3 from_origin = b.x * e1 + b.y * e2 - s;
  return {b, glm::dot(from_origin, ray.direction) / glm::dot(ray.direction, ray.direction)};
}

void hit_row(const Mesh& mesh, const ViewTransform& view, std::uint32_t x, std::uint32_t y,
             const std::uint32_t* triangles, std::size_t n, glm::vec2* barycentrics, float* depths) {
  HWY_DYNAMIC_DISPATCH(hit_pixels)(mesh, view, x, y, triangles, n, barycentrics, depths);
}

}  // namespace lambake
#endif  // HWY_ONCE
