#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lambake/geometry/normal_sums.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lambake/geometry/unit_normals.cpp"
#include <hwy/foreach_target.h>  // compiles the part below once per vector path
#include <hwy/highway.h>

#include "lambake/geometry/transpose-inl.h"

#ifndef LAMBAKE_GEOMETRY_UNIT_NORMALS_ONCE
#define LAMBAKE_GEOMETRY_UNIT_NORMALS_ONCE
namespace lambake {
namespace {

/// A sum of unit normals shorter than this share of the sum of its weights has no direction: the faces
/// cancel.
constexpr double cancelled = 1e-6;

/// Below this share of the sum of its weights, the 1e-7 by which float shares are off shows in the direction.
constexpr double uncertain_share = 0.25;

/// Weights of sums that float takes: squares of sums, of those that almost cancel too, neither overflow nor
/// run dry.
constexpr float least_weight = 1e-12f, greatest_weight = 1e15f;

inline bool is_plain(const NormalSum& sum) {
  const auto weight = static_cast<float>(sum.values[3]);
  return weight == 0 || (weight > least_weight && weight < greatest_weight);
}

glm::vec3 unit_normal_exactly(const NormalSum& sum) {
  const auto& [x, y, z, weight] = sum.values;
  const double length = std::sqrt(x * x + y * y + z * z);
  return length > weight * cancelled ? glm::vec3(x / length, y / length, z / length) : glm::vec3(0);
}

/// In float where the vectors below are: whether a sum is done again must not depend on the others of its
/// window.
bool is_uncertain(const NormalSum& sum) {
  const auto& [x, y, z, weight] = sum.values;
  if (!is_plain(sum)) return std::sqrt(x * x + y * y + z * z) < weight * uncertain_share;
  const glm::vec3 v(x, y, z);
  return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z) <
         static_cast<float>(weight) * static_cast<float>(uncertain_share);
}

}  // namespace
}  // namespace lambake
#endif

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR
/// A sum in float.
HWY_INLINE hn::Vec<hn::FixedTag<float, 4>> row_of(const NormalSum& sum) {
  const hn::FixedTag<float, 4> f;
#if HWY_MAX_BYTES >= 32
  return hn::DemoteTo(f, hn::Load(hn::FixedTag<double, 4>(), sum.values));
#else
  const hn::FixedTag<double, 2> d;
  const hn::Half<decltype(f)> half;
  return hn::Combine(f, hn::DemoteTo(half, hn::Load(d, sum.values + 2)),
                     hn::DemoteTo(half, hn::Load(d, sum.values)));
#endif
}

/// Every fourth sum, as many as a vector takes.
HWY_INLINE F rows_from(const NormalSum* sums) {
#if HWY_MAX_BYTES >= 32
  const hn::FixedTag<float, 8> eight;
  const auto low = hn::Combine(eight, row_of(sums[4]), row_of(sums[0]));
#if HWY_MAX_BYTES >= 64
  return hn::Combine(Floats(), hn::Combine(eight, row_of(sums[12]), row_of(sums[8])), low);
#else
  return low;
#endif
#else
  return row_of(sums[0]);
#endif
}
#endif

/// x, y, z and weight of as many sums as a vector has lanes, in their order.
struct SumVectors {
  F x, y, z, weight;
};

HWY_INLINE SumVectors load_sums(const NormalSum* sums) {
#if HWY_TARGET == HWY_SCALAR
  const Floats f;
  const auto in_float = [&](int k) HWY_ATTR { return hn::Set(f, static_cast<float>(sums->values[k])); };
  return {in_float(0), in_float(1), in_float(2), in_float(3)};
#else
  const FourVectors v =
      transposed({rows_from(sums), rows_from(sums + 1), rows_from(sums + 2), rows_from(sums + 3)});
  return {v.a, v.b, v.c, v.d};
#endif
}

/// In float: right to 2e-7.
/// @param n  a multiple of 16.
bool unit_normals_of(NormalSum* sums, std::size_t n, glm::vec3* normals,
                     std::vector<std::uint32_t>& uncertain) {
  const Floats f;
  const std::size_t lanes = hn::Lanes(f);
  bool have_directions = true;
  for (std::size_t i = 0; i < n; i += lanes) {
    const auto [x, y, z, weight] = load_sums(sums + i);
    const auto length = hn::Sqrt(hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)));
    const auto has_direction = hn::Gt(length, hn::Mul(weight, hn::Set(f, static_cast<float>(cancelled))));
    // Divisions, so that normals along an axis are 1 to the bit.
    const auto over_length = [&](auto a)
                                 HWY_ATTR { return hn::IfThenElseZero(has_direction, hn::Div(a, length)); };
    hn::StoreInterleaved3(over_length(x), over_length(y), over_length(z), f, &normals[i].x);
    const auto is_plain_here = hn::Or(
        hn::Eq(weight, hn::Zero(f)),
        hn::And(hn::Gt(weight, hn::Set(f, least_weight)), hn::Lt(weight, hn::Set(f, greatest_weight))));
    const auto is_certain = hn::AndNot(
        hn::Lt(length, hn::Mul(weight, hn::Set(f, static_cast<float>(uncertain_share)))), is_plain_here);
    have_directions &= hn::AllTrue(f, hn::Or(has_direction, hn::Not(is_certain)));
    if (!hn::AllTrue(f, is_certain))
      for (std::size_t k = i; k < i + lanes; ++k) {
        if (is_uncertain(sums[k])) uncertain.push_back(static_cast<std::uint32_t>(k));
        if (!is_plain(sums[k])) normals[k] = unit_normal_exactly(sums[k]);
        have_directions &= normals[k] != glm::vec3(0);
      }
    std::fill_n(sums + i, lanes, NormalSum{});
  }
  return have_directions;
}

}  // namespace
}  // namespace lambake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lambake {
namespace {
HWY_EXPORT(unit_normals_of);
}  // namespace

bool unit_normals(std::span<NormalSum> sums, std::span<glm::vec3> normals,
                  std::vector<std::uint32_t>& uncertain) {
  // The rest as one vector more, filled with sums of one direction.
  constexpr std::size_t n_lanes = 16;
  const std::size_t n_whole = sums.size() / n_lanes * n_lanes;
  const auto kernel = HWY_DYNAMIC_DISPATCH(unit_normals_of);
  const bool have_whole = kernel(sums.data(), n_whole, normals.data(), uncertain);
  const std::span<NormalSum> rest = sums.subspan(n_whole);
  NormalSum last_sums[n_lanes];
  glm::vec3 last_normals[n_lanes];
  std::fill(std::begin(last_sums), std::end(last_sums), NormalSum{{1, 0, 0, 1}});
  std::copy(rest.begin(), rest.end(), last_sums);
  std::fill(rest.begin(), rest.end(), NormalSum{});
  std::vector<std::uint32_t> last_uncertain;
  const bool have_last = kernel(last_sums, n_lanes, last_normals, last_uncertain);
  std::copy_n(last_normals, rest.size(), normals.begin() + static_cast<std::ptrdiff_t>(n_whole));
  for (const std::uint32_t i : last_uncertain) uncertain.push_back(static_cast<std::uint32_t>(n_whole) + i);
  return have_whole && have_last;
}

}  // namespace lambake
#endif  // HWY_ONCE
