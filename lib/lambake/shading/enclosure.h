#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lambake {

/// A function on a triangle, enclosed (docs/bound.md): for all barycentrics b
///
///     h(b) ∈ Σ b_i linear[i] + Σ b_k b_{k+1} quadratic[k] + [low, high]
///
/// `quadratic[k]` belongs to the side from corner k to corner (k + 1) % 3. Always low <= 0 <= high. Each
/// operation widens the interval by more than what it rounds, so that the enclosure holds for the real
/// numbers that the corner values stand for.
struct Enclosure {
  std::array<double, 3> linear{}, quadratic{};
  double low = 0, high = 0;
};

struct Interval {
  double low = 0, high = 0;
};

/// max of Σ b_k b_{k+1} a[k] over the triangle, for a[k] >= 0: where the a are the squared sides of a
/// triangle that is a bit more than acute, its circumradius squared, otherwise a quarter of the largest.
inline double largest_quadratic(double a, double b, double c) {
  if (a > b) std::swap(a, b);
  if (b > c) std::swap(b, c);
  if (a > b) std::swap(a, b);
  if (!(a + b > c)) return 0.25 * c;
  // Around the smallest, so that needles do not cancel.
  const double between = c - b;
  return std::max(0.25 * c, a * b * c / (a * (2 * (b + c) - a) - between * between));
}

inline double largest_quadratic(const std::array<double, 3>& a, double sign) {
  return largest_quadratic(std::max(0.0, sign * a[0]), std::max(0.0, sign * a[1]),
                           std::max(0.0, sign * a[2]));
}

/// Range of the quadratic part alone.
inline Interval quadratic_range(const Enclosure& e) {
  return {-largest_quadratic(e.quadratic, -1), largest_quadratic(e.quadratic, 1)};
}

/// An interval that holds all values: the better of two estimates on each side.
/// @param quadratic  quadratic_range(e).
inline Interval range(const Enclosure& e, const Interval& quadratic) {
  const auto side = [&](double sign, double bend) {
    double corners = -1e308, bernstein = -1e308;
    for (std::size_t k = 0; k < 3; ++k) {
      corners = std::max(corners, sign * e.linear[k]);
      bernstein = std::max(bernstein, 0.5 * sign * (e.linear[k] + e.linear[(k + 1) % 3] + e.quadratic[k]));
    }
    bernstein = std::max(bernstein, corners);
    return std::min(bernstein, corners + bend);
  };
  return {-side(-1, -quadratic.low) + e.low, side(1, quadratic.high) + e.high};
}

inline Interval range(const Enclosure& e) {
  return range(e, quadratic_range(e));
}

/// At least the largest magnitude of the enclosure's parts.
inline double magnitude(const Enclosure& e) {
  double m = std::max(-e.low, e.high);
  for (std::size_t k = 0; k < 3; ++k) m += std::max(std::abs(e.linear[k]), std::abs(e.quadratic[k]));
  return m;
}

/// For the roundings of one operation on values up to `m` in magnitude: 2^-53 each, with room.
inline void widen(Enclosure& e, double m) {
  constexpr double room = 0x1p-48;
  e.low -= room * m, e.high += room * m;
}

Enclosure operator+(const Enclosure& a, const Enclosure& b);
Enclosure operator*(double s, const Enclosure& a);
Enclosure operator*(const Enclosure& a, const Enclosure& b);

/// max(0, a).
Enclosure positive_part(const Enclosure& a);

/// a^exponent for exponent < 0; a must be positive: `range(a).low > 0`.
Enclosure power(const Enclosure& a, double exponent);

/// Anything in `values`, which holds 0.
inline Enclosure anything_in(const Interval& values) {
  return {{}, {}, values.low, values.high};
}

}  // namespace lambake
