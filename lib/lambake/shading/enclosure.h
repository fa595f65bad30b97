#pragma once

#include <array>

namespace lambake {

/// A function on a triangle, enclosed (docs/bound.md): for all barycentrics b
///
///     h(b) ∈ Σ b_i linear[i] + Σ b_k b_{k+1} quadratic[k] + [low, high]
///
/// `quadratic[k]` belongs to the side from corner k to corner (k + 1) % 3. Always low <= 0 <= high. What is
/// done with enclosures is in enclosure-inl.h.
/// @tparam T  double, or several of them side by side: as many functions.
template <typename T>
struct EnclosureOf {
  std::array<T, 3> linear{}, quadratic{};
  T low{}, high{};
};

using Enclosure = EnclosureOf<double>;

template <typename T>
struct IntervalOf {
  T low{}, high{};
};

using Interval = IntervalOf<double>;

}  // namespace lambake
