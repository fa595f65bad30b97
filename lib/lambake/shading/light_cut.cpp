#include "lambake/shading/light_cut.h"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lambake/shading/light_cut.cpp"
#include <hwy/foreach_target.h>  // compiles the part below once per vector path
#include <hwy/highway.h>

#include "lambake/core/pack-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using V = hn::Vec<Floats>;

constexpr std::size_t lanes = hn::MaxLanes(Floats());
constexpr float infinity = std::numeric_limits<float>::infinity();

/// How far a point and a light may be, together, from where they are: coordinates are floats of at most 1.
constexpr float position_rounding = 2.2e-7f;

V set(float v) {
  return hn::Set(Floats(), v);
}

V load(const float* from) {
  return hn::LoadU(Floats(), from);
}

HWY_INLINE V dot(V ax, V ay, V az, V bx, V by, V bz) {
  return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
}

struct Interval {
  V low = set(infinity), high = set(-infinity);
  HWY_INLINE void add(V v) { low = hn::Min(low, v), high = hn::Max(high, v); }
  float min() const { return hn::GetLane(hn::MinOfLanes(Floats(), low)); }
  float max() const { return hn::GetLane(hn::MaxOfLanes(Floats(), high)); }
  float middle() const { return 0.5f * (min() + max()); }
};

/// Minima and maxima do not depend on the order, hence not on the number of lanes. Lanes beyond the end
/// repeat the last vector's points.
PointBounds bounds_of_points(const PointArrays& p, std::size_t begin, std::size_t end) {
  Interval x, y, z, nx, ny, nz;
  for (std::size_t i = begin; i < end; i += lanes) {
    x.add(load(&p.x[i])), y.add(load(&p.y[i])), z.add(load(&p.z[i]));
    nx.add(load(&p.nx[i])), ny.add(load(&p.ny[i])), nz.add(load(&p.nz[i]));
  }
  PointBounds bounds;
  bounds.center = {x.middle(), y.middle(), z.middle()};
  bounds.axis = {nx.middle(), ny.middle(), nz.middle()};
  const float length = std::sqrt(bounds.axis.x * bounds.axis.x + bounds.axis.y * bounds.axis.y +
                                 bounds.axis.z * bounds.axis.z);
  if (length > 0.1f) bounds.axis /= length;
  const V cx = set(bounds.center.x), cy = set(bounds.center.y), cz = set(bounds.center.z);
  const V ax = set(bounds.axis.x), ay = set(bounds.axis.y), az = set(bounds.axis.z);
  Interval distance_squared, cosine, elevation;
  for (std::size_t i = begin; i < end; i += lanes) {
    const V tx = hn::Sub(load(&p.x[i]), cx), ty = hn::Sub(load(&p.y[i]), cy), tz = hn::Sub(load(&p.z[i]), cz);
    const V mx = load(&p.nx[i]), my = load(&p.ny[i]), mz = load(&p.nz[i]);
    distance_squared.add(dot(tx, ty, tz, tx, ty, tz));
    cosine.add(dot(ax, ay, az, mx, my, mz));
    elevation.add(dot(mx, my, mz, tx, ty, tz));
  }
  // A little wider for the rounding.
  bounds.radius = std::sqrt(distance_squared.max()) * 1.0001f + 1.5f * position_rounding;
  bounds.cos_cone = length > 0.1f ? cosine.min() - 1e-6f : -1.0f;
  // In double: 1 - cos² of a narrow cone is nothing but rounding in float.
  bounds.sin_cone =
      static_cast<float>(std::sqrt(std::max(0.0, 1.0 - double(bounds.cos_cone) * double(bounds.cos_cone))));
  bounds.min_elevation = elevation.min() - 1e-5f * bounds.radius;
  bounds.max_elevation = elevation.max() + 1e-5f * bounds.radius;
  return bounds;
}

/// Sums by lane over sixteen lanes on every path.
struct Sum16 {
  V part[16 / lanes];
  Sum16() {
    for (V& p : part) p = hn::Zero(Floats());
  }
  float total() const {
    HWY_ALIGN float values[16];
    for (std::size_t i = 0; i < 16 / lanes; ++i) hn::Store(part[i], Floats(), values + i * lanes);
    for (int half = 8; half > 0; half /= 2)
      for (int i = 0; i < half; ++i) values[i] += values[i + half];
    return values[0];
  }
};

void weigh(const LightArrays& lights, const PointBounds& bounds, LightWeights& weights,
           std::array<float, 3>& lower) {
  const Floats d;
  const V zero = hn::Zero(d), one = set(1.0f);
  const V cx = set(bounds.center.x), cy = set(bounds.center.y), cz = set(bounds.center.z);
  const V ax = set(bounds.axis.x), ay = set(bounds.axis.y), az = set(bounds.axis.z);
  const V cos_cone = set(bounds.cos_cone), sin_cone = set(bounds.sin_cone), radius = set(bounds.radius);
  const V min_elevation = set(bounds.min_elevation), max_elevation = set(bounds.max_elevation);
  Sum16 sum_r, sum_g, sum_b;
  for (std::size_t i = 0; i < lights.size; i += lanes) {
    const V x = hn::Sub(load(&lights.x[i]), cx), y = hn::Sub(load(&lights.y[i]), cy),
            z = hn::Sub(load(&lights.z[i]), cz);
    const V distance_squared = dot(x, y, z, x, y, z);
    const V distance = hn::Sqrt(distance_squared);
    const V height = dot(ax, ay, az, x, y, z);
    // Of the cross product: d² − height² would be nothing but rounding near the axis.
    const V sx = hn::Sub(hn::Mul(ay, z), hn::Mul(az, y)), sy = hn::Sub(hn::Mul(az, x), hn::Mul(ax, z)),
            sz = hn::Sub(hn::Mul(ax, y), hn::Mul(ay, x));
    const V side = hn::Mul(hn::Sqrt(dot(sx, sy, sz, sx, sy, sz)), sin_cone);
    const V along = hn::Mul(height, cos_cone);
    const V slack =
        hn::Add(hn::Mul(distance, set(1e-5f)), set(position_rounding));  // 1e-5: of the rounding here
    // n·(x_i − p) over all normals and points: n·(x_i − c) less the elevation of p.
    const V facing_high = hn::Add(
        hn::Sub(hn::IfThenElse(hn::Ge(height, hn::Mul(distance, cos_cone)), distance, hn::Add(along, side)),
                min_elevation),
        slack);
    const V facing_low = hn::Sub(hn::Sub(hn::Sub(along, side), max_elevation), slack);
    const V nearest = hn::Sub(distance, hn::Mul(radius, set(1.001f)));
    const V farthest = hn::Add(distance, radius);
    const V by_nearest = hn::Div(one, nearest);
    const V by_nearest_3 = hn::Mul(hn::Mul(by_nearest, by_nearest), by_nearest);
    const V dropped = hn::Mul(hn::Max(zero, facing_high), by_nearest_3);
    // 1/d² · remainder(radius/d) = (order + 1.5) q^order / (d − radius)²; the second term is for points that
    // the light is behind, 3e-5 the rounding of the field's sums, of handing it down and of its evaluation,
    // the last one that of positions: light changes by at most 2/d³ with them.
    const V ratio = hn::Div(radius, distance);
    V remainder = set(LightField::order + 1.5f);
    for (int l = 0; l < LightField::order; ++l) remainder = hn::Mul(remainder, ratio);
    const V by_nearest_2 = hn::Mul(by_nearest, by_nearest);
    const V merged = hn::Add(
        hn::Mul(hn::Add(remainder, set(3e-5f)), by_nearest_2),
        hn::Mul(hn::Add(hn::Max(zero, hn::Neg(facing_low)), set(2 * position_rounding)), by_nearest_3));
    const V is_far = hn::VecFromMask(d, hn::Gt(distance, hn::Mul(radius, set(2.0f))));
    const auto far = hn::MaskFromVec(is_far);
    const auto merge = hn::Lt(merged, dropped);
    // Lights that are behind all points give nothing, however near.
    const V any_distance = hn::IfThenElse(hn::Le(facing_high, zero), zero, set(infinity));
    hn::StoreU(
        hn::IfThenElse(far, hn::Mul(hn::IfThenElse(merge, merged, dropped), set(1.003f)), any_distance), d,
        &weights.error[i]);
    hn::StoreU(hn::IfThenElseZero(hn::And(far, merge), one), d, &weights.is_merged[i]);
    hn::StoreU(hn::IfThenElseZero(hn::And(far, hn::Gt(facing_high, zero)), hn::Div(one, distance_squared)), d,
               &weights.own[i]);
    const V least = hn::Div(hn::Mul(hn::Max(zero, facing_low), set(0.999f)),
                            hn::Mul(hn::Mul(farthest, farthest), farthest));
    hn::StoreU(least, d, &weights.least[i]);
    const std::size_t part = i / lanes % (16 / lanes);
    sum_r.part[part] = hn::Add(sum_r.part[part], hn::Mul(least, load(&lights.r[i])));
    sum_g.part[part] = hn::Add(sum_g.part[part], hn::Mul(least, load(&lights.g[i])));
    sum_b.part[part] = hn::Add(sum_b.part[part], hn::Mul(least, load(&lights.b[i])));
  }
  lower = {sum_r.total() * 0.999f, sum_g.total() * 0.999f, sum_b.total() * 0.999f};
}

/// Intensity of light i in units of what is allowed: the largest of its channels.
struct Shares {
  V r, g, b;
  explicit Shares(const std::array<float, 3>& allowed)
      : r(set(1.0f / allowed[0])), g(set(1.0f / allowed[1])), b(set(1.0f / allowed[2])) {}
  HWY_INLINE V intensity(const LightArrays& lights, std::size_t i) const {
    return hn::Max(hn::Mul(load(&lights.r[i]), r),
                   hn::Max(hn::Mul(load(&lights.g[i]), g), hn::Mul(load(&lights.b[i]), b)));
  }
  /// Its error; a black light has none, not even where the error is infinite.
  HWY_INLINE V error(const LightArrays& lights, const LightWeights& weights, std::size_t i) const {
    const V largest = intensity(lights, i);
    return hn::IfThenElseZero(hn::Gt(largest, hn::Zero(Floats())), hn::Mul(largest, load(&weights.error[i])));
  }
};

float sum_of_own_light(const LightArrays& lights, const LightWeights& weights,
                       const std::array<float, 3>& allowed) {
  const Shares shares(allowed);
  Sum16 sum;
  for (std::size_t i = 0; i < lights.size; i += lanes) {
    V& part = sum.part[i / lanes % (16 / lanes)];
    part = hn::Add(part, hn::Mul(shares.intensity(lights, i), load(&weights.own[i])));
  }
  return sum.total();
}

template <class M>
HWY_INLINE void append(const LightArrays& from, std::size_t i, M mask, LightArrays& to) {
  const Floats d;
  const hn::RebindToUnsigned<Floats> du;
  const std::size_t at = to.size;
  const Packing<Floats> pack(d, mask);
  hn::StoreU(pack(load(&from.x[i])), d, &to.x[at]);
  hn::StoreU(pack(load(&from.y[i])), d, &to.y[at]);
  hn::StoreU(pack(load(&from.z[i])), d, &to.z[at]);
  hn::StoreU(pack(load(&from.r[i])), d, &to.r[at]);
  hn::StoreU(pack(load(&from.g[i])), d, &to.g[at]);
  hn::StoreU(pack(load(&from.b[i])), d, &to.b[at]);
  hn::StoreU(pack(hn::LoadU(du, &from.index[i])), du, &to.index[at]);
  to.size += hn::CountTrue(d, mask);
}

float highest_level(const LightArrays& lights, const LightWeights& weights,
                    const std::array<float, 3>& allowed, float budget) {
  if (lights.size == 0) return 0;
  const Shares shares(allowed);
  // The first level always keeps the budget.
  constexpr int n_levels = 7;
  float levels[n_levels] = {0.99f * budget / static_cast<float>(lights.size)};
  for (int t = 1; t < n_levels; ++t) levels[t] = levels[t - 1] * 3.0f;
  Sum16 sums[n_levels];
  for (std::size_t i = 0; i < lights.size; i += lanes) {
    const V error = shares.error(lights, weights, i);
    for (int t = 0; t < n_levels; ++t) {
      V& sum = sums[t].part[i / lanes % (16 / lanes)];
      sum = hn::Add(sum, hn::IfThenElseZero(hn::Le(error, set(levels[t])), error));
    }
  }
  int chosen = 0;
  for (int t = 1; t < n_levels; ++t)
    if (sums[t].total() * 1.002f <= budget) chosen = t;
  return levels[chosen];
}

void cut(const LightArrays& lights, const LightWeights& weights, const std::array<float, 3>& allowed,
         CutLine line, LightArrays& merged, LightArrays& rest, Cut& result) {
  const Floats d;
  const Shares shares(allowed);
  const bool is_by_own = line.by == CutLine::By::own_light;
  const V level = set(line.level);
  Sum16 share, error_r, error_g, error_b, lower_r, lower_g, lower_b;
  for (std::size_t i = 0; i < lights.size; i += lanes) {
    const auto is_inside = hn::FirstN(d, std::min(lanes, lights.size - i));
    const V own_share = shares.error(lights, weights, i);
    const auto is_below = is_by_own ? hn::Le(load(&weights.error[i]), hn::Mul(level, load(&weights.own[i])))
                                    : hn::Le(own_share, level);
    const auto is_settled = hn::And(is_below, is_inside);
    const V error = hn::IfThenElseZero(is_settled, hn::Min(load(&weights.error[i]), set(3e38f)));
    const std::size_t part = i / lanes % (16 / lanes);
    share.part[part] = hn::Add(share.part[part], hn::IfThenElseZero(is_settled, own_share));
    error_r.part[part] = hn::Add(error_r.part[part], hn::Mul(error, load(&lights.r[i])));
    error_g.part[part] = hn::Add(error_g.part[part], hn::Mul(error, load(&lights.g[i])));
    error_b.part[part] = hn::Add(error_b.part[part], hn::Mul(error, load(&lights.b[i])));
    const auto is_merged = hn::And(is_settled, hn::Gt(load(&weights.is_merged[i]), hn::Zero(d)));
    const V least = hn::IfThenElseZero(is_merged, load(&weights.least[i]));
    lower_r.part[part] = hn::Add(lower_r.part[part], hn::Mul(least, load(&lights.r[i])));
    lower_g.part[part] = hn::Add(lower_g.part[part], hn::Mul(least, load(&lights.g[i])));
    lower_b.part[part] = hn::Add(lower_b.part[part], hn::Mul(least, load(&lights.b[i])));
    append(lights, i, is_merged, merged);
    append(lights, i, hn::AndNot(is_settled, is_inside), rest);
  }
  result.share = share.total() * 1.001f;
  result.lower = {lower_r.total() * 0.999f, lower_g.total() * 0.999f, lower_b.total() * 0.999f};
  result.error = {error_r.total() * 1.001f, error_g.total() * 1.001f, error_b.total() * 1.001f};
}

}  // namespace
}  // namespace lambake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lambake {
namespace {
HWY_EXPORT(bounds_of_points);
HWY_EXPORT(weigh);
HWY_EXPORT(sum_of_own_light);
HWY_EXPORT(highest_level);
HWY_EXPORT(cut);

/// What vectors read beyond the end: black copies of the last light.
void blacken_padding(LightArrays& lights) {
  if (lights.size == 0) return;
  for (std::vector<float>* array : {&lights.x, &lights.y, &lights.z})
    std::fill_n(array->begin() + static_cast<std::ptrdiff_t>(lights.size), LightArrays::lane_padding,
                (*array)[lights.size - 1]);
  for (std::vector<float>* array : {&lights.r, &lights.g, &lights.b})
    std::fill_n(array->begin() + static_cast<std::ptrdiff_t>(lights.size), LightArrays::lane_padding, 0.0f);
}
}  // namespace

void LightWeights::reserve(std::size_t n) {
  if (error.size() >= n + LightArrays::lane_padding) return;
  for (std::vector<float>* array : {&error, &own, &is_merged, &least})
    array->resize(n + LightArrays::lane_padding);
}

PointBounds bound_points(const PointArrays& points, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(bounds_of_points)(points, begin, end);
}

std::array<float, 3> weigh_lights(const LightArrays& lights, const PointBounds& bounds,
                                  LightWeights& weights) {
  std::array<float, 3> lower{};
  HWY_DYNAMIC_DISPATCH(weigh)(lights, bounds, weights, lower);
  return lower;
}

CutLine line_by_own_light(const LightArrays& lights, const LightWeights& weights,
                          const std::array<float, 3>& allowed, float budget) {
  const float sum = HWY_DYNAMIC_DISPATCH(sum_of_own_light)(lights, weights, allowed);
  return {CutLine::By::own_light, sum > 0 ? budget / sum : 0.0f};
}

CutLine line_by_error(const LightArrays& lights, const LightWeights& weights,
                      const std::array<float, 3>& allowed, float budget) {
  return {CutLine::By::error, HWY_DYNAMIC_DISPATCH(highest_level)(lights, weights, allowed, budget)};
}

Cut cut_lights(const LightArrays& lights, const LightWeights& weights, const std::array<float, 3>& allowed,
               CutLine line, LightArrays& merged, LightArrays& rest) {
  Cut result;
  merged.size = rest.size = 0;
  HWY_DYNAMIC_DISPATCH(cut)(lights, weights, allowed, line, merged, rest, result);
  blacken_padding(merged);
  blacken_padding(rest);
  return result;
}

}  // namespace lambake
#endif  // HWY_ONCE
