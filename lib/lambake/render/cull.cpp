#include "lambake/render/cull.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lambake/render/cull.cpp"
#include <hwy/foreach_target.h>  // compiles the part below once per vector path
#include <hwy/highway.h>

#include "lambake/core/pack-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Ints = hn::CappedTag<std::int32_t, 16>;
using V = hn::Vec<Ints>;
using M = hn::Mask<Ints>;

struct V2 {
  V x, y;
};

/// One edge function (raster_setup.h) of small triangles, whose coordinates differ by less than 2^10: with
/// the top-left rule in `bias`, >= 0 is inside.
struct Edge {
  V2 from;
  V dx, dy, bias;

  Edge(const V2& a, const V2& b) : from(a), dx(hn::Sub(b.x, a.x)), dy(hn::Sub(b.y, a.y)) {
    const Ints i32;
    const V zero = hn::Zero(i32);
    const M is_top_left = hn::Or(hn::Lt(dy, zero), hn::And(hn::Eq(dy, zero), hn::Gt(dx, zero)));
    bias = hn::IfThenElse(is_top_left, zero, hn::Set(i32, -1));
  }
  HWY_INLINE V at(V x, V y) const {
    return hn::Add(hn::Sub(hn::Mul(dx, hn::Sub(y, from.y)), hn::Mul(dy, hn::Sub(x, from.x))), bias);
  }
};

HWY_INLINE V min3(V a, V b, V c) {
  return hn::Min(a, hn::Min(b, c));
}
HWY_INLINE V max3(V a, V b, V c) {
  return hn::Max(a, hn::Max(b, c));
}

/// Whether one of the 2×2 pixel centres from (x, y) in subpixels on is inside.
HWY_INLINE M reaches_a_centre(const V2& v0, const V2& v1, const V2& v2, M is_clockwise, V x, V y) {
  const Ints i32;
  const V2 second{hn::IfThenElse(is_clockwise, v1.x, v2.x), hn::IfThenElse(is_clockwise, v1.y, v2.y)};
  const V2 third{hn::IfThenElse(is_clockwise, v2.x, v1.x), hn::IfThenElse(is_clockwise, v2.y, v1.y)};
  const Edge e0(v0, second), e1(second, third), e2(third, v0);
  V all_outside = hn::Set(i32, -1);  // its sign: no centre yet
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const V px = hn::Add(x, hn::Set(i32, i * subpixels)), py = hn::Add(y, hn::Set(i32, j * subpixels));
      all_outside = hn::And(all_outside, hn::Or(e0.at(px, py), hn::Or(e1.at(px, py), e2.at(px, py))));
    }
  return hn::Gt(all_outside, hn::Set(i32, -1));
}

/// Corners of triangles one after the other, as vectors load them: copying them is cheaper than gathering.
struct CornerBatch {
  static constexpr std::size_t size = 64;
  HWY_ALIGN ScreenVertex at[3][size];
};

/// The triangles from `i` of the batch on that may be seen.
HWY_INLINE M may_be_seen(const CornerBatch& corners, std::size_t i) {
  const Ints i32;
  const V zero = hn::Zero(i32);
  V2 v[3];
  V common = hn::Set(i32, -1), any = zero;
  for (int c = 0; c < 3; ++c) {
    V nearness, outcode;
    hn::LoadInterleaved4(i32, &corners.at[c][i].x, v[c].x, v[c].y, nearness, outcode);
    common = hn::And(common, outcode);
    any = hn::Or(any, outcode);
  }
  const M is_aside = hn::Or(hn::Ne(hn::And(common, hn::Set(i32, unseen_if_common)), zero),
                            hn::Ne(hn::And(any, hn::Set(i32, not_finite)), zero));
  const M is_clipped = hn::Ne(hn::And(any, hn::Set(i32, clipped_if_any)), zero);

  // The pixels whose centres lie in the box.
  const V half = hn::Set(i32, subpixels / 2), almost_half = hn::Set(i32, subpixels / 2 - 1);
  const V x_begin = hn::ShiftRight<subpixel_bits>(hn::Add(min3(v[0].x, v[1].x, v[2].x), almost_half));
  const V y_begin = hn::ShiftRight<subpixel_bits>(hn::Add(min3(v[0].y, v[1].y, v[2].y), almost_half));
  const V x_last = hn::ShiftRight<subpixel_bits>(hn::Sub(max3(v[0].x, v[1].x, v[2].x), half));
  const V y_last = hn::ShiftRight<subpixel_bits>(hn::Sub(max3(v[0].y, v[1].y, v[2].y), half));
  const V columns = hn::Sub(x_last, x_begin), rows = hn::Sub(y_last, y_begin);  // less one
  const M has_centres = hn::Gt(hn::Min(columns, rows), hn::Set(i32, -1));
  const M is_small = hn::Lt(hn::Max(columns, rows), hn::Set(i32, 2));
  M is_seen = has_centres;
  if (!hn::AllFalse(i32, hn::And(is_small, has_centres))) {
    const V twice_area = hn::Sub(hn::Mul(hn::Sub(v[1].x, v[0].x), hn::Sub(v[2].y, v[0].y)),
                                 hn::Mul(hn::Sub(v[1].y, v[0].y), hn::Sub(v[2].x, v[0].x)));
    const M reaches = reaches_a_centre(v[0], v[1], v[2], hn::Gt(twice_area, zero),
                                       hn::Add(hn::ShiftLeft<subpixel_bits>(x_begin), half),
                                       hn::Add(hn::ShiftLeft<subpixel_bits>(y_begin), half));
    is_seen = hn::And(is_seen, hn::Or(hn::Not(is_small), hn::And(reaches, hn::Ne(twice_area, zero))));
  }
  return hn::AndNot(is_aside, hn::Or(is_clipped, is_seen));
}

/// Writes the candidates to `out`, which has room for all and a vector more; returns how many there are.
std::size_t candidates_of(std::span<const ScreenVertex> vertices, std::span<const glm::uvec3> triangles,
                          std::size_t begin, std::size_t end, std::uint32_t* out) {
  const Ints i32;
  const std::size_t lanes = hn::Lanes(i32);
  std::int32_t* next = reinterpret_cast<std::int32_t*>(out);
  CornerBatch corners{};  // what lanes past the end read
  for (std::size_t first = begin; first < end; first += CornerBatch::size) {
    const std::size_t n = std::min(CornerBatch::size, end - first);
    for (std::size_t i = 0; i < n; ++i)
      for (int c = 0; c < 3; ++c) corners.at[c][i] = vertices[triangles[first + i][c]];
    for (std::size_t i = 0; i < n; i += lanes) {
      const M seen = hn::And(may_be_seen(corners, i), hn::FirstN(i32, std::min(lanes, n - i)));
      const V index = hn::Iota(i32, static_cast<std::int32_t>(first + i));
      hn::StoreU(Packing<Ints>(i32, seen)(index), i32, next);
      next += hn::CountTrue(i32, seen);
    }
  }
  return static_cast<std::size_t>(next - reinterpret_cast<std::int32_t*>(out));
}

}  // namespace
}  // namespace lambake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lambake {

static_assert(sizeof(glm::uvec3) == 3 * sizeof(std::int32_t));

namespace {
HWY_EXPORT(candidates_of);
}  // namespace

void find_candidates(std::span<const ScreenVertex> vertices, std::span<const glm::uvec3> triangles,
                     std::size_t begin, std::size_t end, std::vector<std::uint32_t>& candidates) {
  constexpr std::size_t longest_vector = 16;
  const std::size_t n_before = candidates.size();
  candidates.resize(n_before + (end - begin) + longest_vector);
  candidates.resize(n_before + HWY_DYNAMIC_DISPATCH(candidates_of)(vertices, triangles, begin, end,
                                                                   candidates.data() + n_before));
}

}  // namespace lambake
#endif  // HWY_ONCE
