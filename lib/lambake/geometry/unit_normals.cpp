#include <algorithm>
#include <cmath>
#include <cstddef>

#include "lambake/geometry/normal_sums.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lambake/geometry/unit_normals.cpp"
#include <hwy/foreach_target.h>  // compiles the part below once per vector path
#include <hwy/highway.h>

#ifndef LAMBAKE_GEOMETRY_UNIT_NORMALS_ONCE
#define LAMBAKE_GEOMETRY_UNIT_NORMALS_ONCE
namespace lambake {
namespace {

/// A sum of unit normals shorter than this share of the sum of its weights has no direction: the faces
/// cancel.
constexpr double cancelled = 1e-6;

/// Below this share of the sum of its weights, the 1e-7 by which float shares are off shows in the direction.
constexpr double uncertain = 0.25;

/// Weights of sums that float takes: squares of sums, of those that almost cancel too, neither overflow nor
/// run dry.
constexpr float least_weight = 1e-12f, greatest_weight = 1e15f;

inline bool is_plain(const NormalSum& sum) {
  const auto weight = static_cast<float>(sum.values[3]);
  return weight == 0 || (weight > least_weight && weight < greatest_weight);
}

glm::vec3 unit_normal_exactly(const NormalSum& sum, UnitNormalCounts& counts) {
  const auto& [x, y, z, weight] = sum.values;
  const double length = std::sqrt(x * x + y * y + z * z);
  counts.n_uncertain += length < weight * uncertain;
  if (length > weight * cancelled) return glm::vec3(x / length, y / length, z / length);
  ++counts.n_without;
  return glm::vec3(0);
}

}  // namespace
}  // namespace lambake
#endif

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

/// In float, two vectors of double at a time: right to 2e-7.
/// @param n  a multiple of 8.
UnitNormalCounts unit_normals_of(const NormalSum* sums, std::size_t n, glm::vec3* normals) {
  const hn::CappedTag<double, 4> d;
  const hn::Rebind<float, decltype(d)> half;
#if HWY_TARGET == HWY_SCALAR
  const decltype(half) f;
#else
  const hn::Twice<decltype(half)> f;
#endif
  using D = hn::Vec<decltype(d)>;
  const std::size_t lanes = hn::Lanes(f);
  UnitNormalCounts counts;
  for (std::size_t i = 0; i < n; i += lanes) {
    D low[4], high[4];
    hn::LoadInterleaved4(d, sums[i].values, low[0], low[1], low[2], low[3]);
    hn::LoadInterleaved4(d, sums[i + lanes - hn::Lanes(d)].values, high[0], high[1], high[2], high[3]);
    const auto in_float = [&](int k) HWY_ATTR {
#if HWY_TARGET == HWY_SCALAR
      return hn::DemoteTo(half, low[k]);
#else
      return hn::Combine(f, hn::DemoteTo(half, high[k]), hn::DemoteTo(half, low[k]));
#endif
    };
    const auto x = in_float(0), y = in_float(1), z = in_float(2), weight = in_float(3);
    const auto length = hn::Sqrt(hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)));
    const auto has_direction = hn::Gt(length, hn::Mul(weight, hn::Set(f, static_cast<float>(cancelled))));
    // Divisions, so that normals along an axis are 1 to the bit.
    const auto over_length = [&](auto a)
                                 HWY_ATTR { return hn::IfThenElseZero(has_direction, hn::Div(a, length)); };
    hn::StoreInterleaved3(over_length(x), over_length(y), over_length(z), f, &normals[i].x);
    const auto is_plain_here = hn::Or(
        hn::Eq(weight, hn::Zero(f)),
        hn::And(hn::Gt(weight, hn::Set(f, least_weight)), hn::Lt(weight, hn::Set(f, greatest_weight))));
    counts.n_without += hn::CountTrue(f, hn::AndNot(has_direction, is_plain_here));
    counts.n_uncertain += hn::CountTrue(
        f,
        hn::And(is_plain_here, hn::Lt(length, hn::Mul(weight, hn::Set(f, static_cast<float>(uncertain))))));
    if (hn::AllTrue(f, is_plain_here)) continue;
    for (std::size_t k = i; k < i + lanes; ++k)
      if (!is_plain(sums[k])) normals[k] = unit_normal_exactly(sums[k], counts);
  }
  return counts;
}

}  // namespace
}  // namespace lambake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lambake {
namespace {
HWY_EXPORT(unit_normals_of);
}  // namespace

bool is_uncertain(const NormalSum& sum) {
  if (!is_plain(sum)) {
    UnitNormalCounts counts;
    unit_normal_exactly(sum, counts);
    return counts.n_uncertain > 0;
  }
  // In float, as above: whether a sum is done again must not depend on the others of its window.
  const glm::vec3 v(sum.values[0], sum.values[1], sum.values[2]);
  return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z) <
         static_cast<float>(sum.values[3]) * static_cast<float>(uncertain);
}

UnitNormalCounts unit_normals(std::span<const NormalSum> sums, std::span<glm::vec3> normals) {
  // The rest as one vector more, filled with sums of one direction.
  constexpr std::size_t n_lanes = 8;
  const std::size_t n_whole = sums.size() / n_lanes * n_lanes;
  const auto kernel = HWY_DYNAMIC_DISPATCH(unit_normals_of);
  const UnitNormalCounts whole = kernel(sums.data(), n_whole, normals.data());
  NormalSum last_sums[n_lanes];
  glm::vec3 last_normals[n_lanes];
  std::fill(std::begin(last_sums), std::end(last_sums), NormalSum{{1, 0, 0, 1}});
  std::copy(sums.begin() + static_cast<std::ptrdiff_t>(n_whole), sums.end(), last_sums);
  const UnitNormalCounts last = kernel(last_sums, n_lanes, last_normals);
  std::copy_n(last_normals, sums.size() - n_whole, normals.begin() + static_cast<std::ptrdiff_t>(n_whole));
  return {whole.n_without + last.n_without, whole.n_uncertain + last.n_uncertain};
}

}  // namespace lambake
#endif  // HWY_ONCE
