#include <algorithm>
#include <cmath>

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

}  // namespace
}  // namespace lambake
#endif

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

UnitNormalCounts unit_normals_of(const NormalSum* sums, std::size_t n, glm::vec3* normals) {
  const hn::CappedTag<double, 8> d;
  const hn::Rebind<float, decltype(d)> f;
  const std::size_t lanes = hn::Lanes(d);
  UnitNormalCounts counts;
  for (std::size_t i = 0; i + lanes <= n; i += lanes) {
    hn::Vec<decltype(d)> x, y, z, weight;
    hn::LoadInterleaved4(d, sums[i].values, x, y, z, weight);
    const auto length = hn::Sqrt(hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)));
    const auto has_direction = hn::Gt(length, hn::Mul(weight, hn::Set(d, cancelled)));
    const auto reciprocal = hn::IfThenElseZero(has_direction, hn::Div(hn::Set(d, 1.0), length));
    hn::StoreInterleaved3(hn::DemoteTo(f, hn::Mul(x, reciprocal)), hn::DemoteTo(f, hn::Mul(y, reciprocal)),
                          hn::DemoteTo(f, hn::Mul(z, reciprocal)), f, &normals[i].x);
    counts.n_without += lanes - hn::CountTrue(d, has_direction);
    counts.n_uncertain += hn::CountTrue(d, hn::Lt(length, hn::Mul(weight, hn::Set(d, uncertain))));
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
  const auto& [x, y, z, weight] = sum.values;
  return std::sqrt(x * x + y * y + z * z) < weight * uncertain;
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
