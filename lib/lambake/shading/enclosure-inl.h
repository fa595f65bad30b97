/// What is done with enclosures, of one function or of four at a time. Included by each vector path: the
/// guard lets it in once for each.
///
/// Each operation widens the interval by more than what it rounds, so that the enclosure holds for the real
/// numbers that the corner values stand for. Where the four differ in what is to be done, all is done and the
/// right one is taken for each: a function has the same bits whatever the others are.
#if defined(LAMBAKE_SHADING_ENCLOSURE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LAMBAKE_SHADING_ENCLOSURE_INL_H
#undef LAMBAKE_SHADING_ENCLOSURE_INL_H
#else
#define LAMBAKE_SHADING_ENCLOSURE_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "lambake/shading/enclosure.h"

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using LaneTag = hn::CappedTag<double, 4>;
constexpr std::size_t n_lanes = hn::MaxLanes(LaneTag());

/// Numbers side by side, with the operators of one.
struct Lanes {
  hn::Vec<LaneTag> v;
  Lanes() = default;
  HWY_INLINE Lanes(hn::Vec<LaneTag> vector) : v(vector) {}
  HWY_INLINE Lanes(double all) : v(hn::Set(LaneTag(), all)) {}
};

struct LaneMask {
  hn::Mask<LaneTag> m;
};

HWY_INLINE Lanes operator+(Lanes a, Lanes b) {
  return hn::Add(a.v, b.v);
}
HWY_INLINE Lanes operator-(Lanes a, Lanes b) {
  return hn::Sub(a.v, b.v);
}
HWY_INLINE Lanes operator-(Lanes a) {
  return hn::Neg(a.v);
}
HWY_INLINE Lanes operator*(Lanes a, Lanes b) {
  return hn::Mul(a.v, b.v);
}
HWY_INLINE Lanes operator/(Lanes a, Lanes b) {
  return hn::Div(a.v, b.v);
}
HWY_INLINE LaneMask operator<(Lanes a, Lanes b) {
  return {hn::Lt(a.v, b.v)};
}
HWY_INLINE LaneMask operator<=(Lanes a, Lanes b) {
  return {hn::Le(a.v, b.v)};
}
HWY_INLINE LaneMask operator&(LaneMask a, LaneMask b) {
  return {hn::And(a.m, b.m)};
}
HWY_INLINE LaneMask operator|(LaneMask a, LaneMask b) {
  return {hn::Or(a.m, b.m)};
}

HWY_INLINE Lanes least(Lanes a, Lanes b) {
  return hn::Min(a.v, b.v);
}
HWY_INLINE Lanes most(Lanes a, Lanes b) {
  return hn::Max(a.v, b.v);
}
HWY_INLINE Lanes absolute(Lanes a) {
  return hn::Abs(a.v);
}
HWY_INLINE Lanes root(Lanes a) {
  return hn::Sqrt(a.v);
}
HWY_INLINE bool all(LaneMask a) {
  return hn::AllTrue(LaneTag(), a.m);
}
HWY_INLINE Lanes select(LaneMask m, Lanes a, Lanes b) {
  return hn::IfThenElse(m.m, a.v, b.v);
}
inline Lanes power_of(Lanes x, double exponent) {
  HWY_ALIGN double values[n_lanes];
  hn::Store(x.v, LaneTag(), values);
  for (double& value : values) value = std::pow(value, exponent);
  return hn::Load(LaneTag(), values);
}

HWY_INLINE double least(double a, double b) {
  return std::min(a, b);
}
HWY_INLINE double most(double a, double b) {
  return std::max(a, b);
}
HWY_INLINE double absolute(double a) {
  return std::abs(a);
}
HWY_INLINE double root(double a) {
  return std::sqrt(a);
}
HWY_INLINE bool all(bool a) {
  return a;
}
HWY_INLINE double select(bool m, double a, double b) {
  return m ? a : b;
}
HWY_INLINE double power_of(double x, double exponent) {
  return std::pow(x, exponent);
}

template <typename T>
HWY_INLINE T least(T a, T b, T c) {
  return least(least(a, b), c);
}
template <typename T>
HWY_INLINE T most(T a, T b, T c) {
  return most(most(a, b), c);
}

template <typename T, typename Mask>
HWY_INLINE IntervalOf<T> select(Mask m, const IntervalOf<T>& a, const IntervalOf<T>& b) {
  return {select(m, a.low, b.low), select(m, a.high, b.high)};
}

template <typename T, typename Mask>
HWY_INLINE EnclosureOf<T> select(Mask m, const EnclosureOf<T>& a, const EnclosureOf<T>& b) {
  EnclosureOf<T> e;
  for (std::size_t k = 0; k < 3; ++k) {
    e.linear[k] = select(m, a.linear[k], b.linear[k]);
    e.quadratic[k] = select(m, a.quadratic[k], b.quadratic[k]);
  }
  e.low = select(m, a.low, b.low), e.high = select(m, a.high, b.high);
  return e;
}

/// The same at all three corners, or linear between them.
template <typename T>
HWY_INLINE EnclosureOf<T> linear(T a, T b, T c) {
  EnclosureOf<T> e;
  e.linear = {a, b, c};
  return e;
}

/// Anything in `values`, which holds 0.
template <typename T>
HWY_INLINE EnclosureOf<T> anything_in(const IntervalOf<T>& values) {
  EnclosureOf<T> e;
  e.low = values.low, e.high = values.high;
  return e;
}

/// max of Σ b_k b_{k+1} a[k] over the triangle, for a[k] >= 0: where the a are the squared sides of a
/// triangle that is a bit more than acute, its circumradius squared, otherwise a quarter of the largest.
template <typename T>
HWY_INLINE T largest_quadratic(T x, T y, T z) {
  const T low = least(x, y), high = most(x, y);
  const T a = least(low, z), b = most(low, least(high, z)), c = most(high, z);
  const T quarter = T(0.25) * c, between = c - b;
  // Around the smallest, so that needles do not cancel.
  const T inside = a * b * c / (a * (T(2) * (b + c) - a) - between * between);
  return select(c < a + b, most(quarter, inside), quarter);
}

/// Range of the quadratic part alone.
template <typename T>
HWY_INLINE IntervalOf<T> quadratic_range(const EnclosureOf<T>& e) {
  const T zero(0.0);
  return {
      -largest_quadratic(most(zero, -e.quadratic[0]), most(zero, -e.quadratic[1]),
                         most(zero, -e.quadratic[2])),
      largest_quadratic(most(zero, e.quadratic[0]), most(zero, e.quadratic[1]), most(zero, e.quadratic[2]))};
}

/// An interval that holds all values: on each side the better of two estimates, the corners and the bend on
/// top, or the coefficients in the Bernstein basis.
/// @param quadratic  quadratic_range(e).
template <typename T>
HWY_INLINE IntervalOf<T> range(const EnclosureOf<T>& e, const IntervalOf<T>& quadratic) {
  const T low = least(e.linear[0], e.linear[1], e.linear[2]),
          high = most(e.linear[0], e.linear[1], e.linear[2]);
  T least_between = low, most_between = high;
  for (std::size_t k = 0; k < 3; ++k) {
    const T between = T(0.5) * (e.linear[k] + e.linear[(k + 1) % 3] + e.quadratic[k]);
    least_between = least(least_between, between), most_between = most(most_between, between);
  }
  return {most(least_between, low + quadratic.low) + e.low,
          least(most_between, high + quadratic.high) + e.high};
}

template <typename T>
HWY_INLINE IntervalOf<T> range(const EnclosureOf<T>& e) {
  return range(e, quadratic_range(e));
}

/// At least the largest magnitude of the enclosure's parts; not a number if one of them is not.
template <typename T>
HWY_INLINE T magnitude(const EnclosureOf<T>& e) {
  T m = e.high - e.low;
  for (std::size_t k = 0; k < 3; ++k) m = m + absolute(e.linear[k]) + absolute(e.quadratic[k]);
  return m;
}

/// For the roundings of one operation on values up to `m` in magnitude: 2^-53 each, with room.
template <typename T>
HWY_INLINE void widen(EnclosureOf<T>& e, T m) {
  const T room = T(0x1p-48) * m;
  e.low = e.low - room, e.high = e.high + room;
}

template <typename T>
HWY_INLINE EnclosureOf<T> operator+(const EnclosureOf<T>& a, const EnclosureOf<T>& b) {
  EnclosureOf<T> sum;
  for (std::size_t k = 0; k < 3; ++k) {
    sum.linear[k] = a.linear[k] + b.linear[k];
    sum.quadratic[k] = a.quadratic[k] + b.quadratic[k];
  }
  sum.low = a.low + b.low, sum.high = a.high + b.high;
  widen(sum, magnitude(a) + magnitude(b));
  return sum;
}

template <typename T>
HWY_INLINE EnclosureOf<T> scaled(T s, const EnclosureOf<T>& a) {
  EnclosureOf<T> e;
  for (std::size_t k = 0; k < 3; ++k) e.linear[k] = s * a.linear[k], e.quadratic[k] = s * a.quadratic[k];
  const T low = s * a.low, high = s * a.high;
  e.low = least(low, high), e.high = most(low, high);
  widen(e, absolute(s) * magnitude(a));
  return e;
}

template <typename T>
HWY_INLINE EnclosureOf<T> negative(const EnclosureOf<T>& a) {
  EnclosureOf<T> e;
  for (std::size_t k = 0; k < 3; ++k) e.linear[k] = -a.linear[k], e.quadratic[k] = -a.quadratic[k];
  e.low = -a.high, e.high = -a.low;
  return e;
}

template <typename T>
HWY_INLINE IntervalOf<T> times(const IntervalOf<T>& a, const IntervalOf<T>& b) {
  const T p = a.low * b.low, q = a.low * b.high, r = a.high * b.low, s = a.high * b.high;
  return {least(least(p, q), least(r, s)), most(most(p, q), most(r, s))};
}

/// The polynomial part of `e` times the interval of another factor.
/// @param size, other_size  magnitudes of the two.
template <typename T>
HWY_INLINE IntervalOf<T> by_interval(const EnclosureOf<T>& e, T size, const IntervalOf<T>& quadratic,
                                     const IntervalOf<T>& interval, T other_size) {
  const T width = interval.high - interval.low;
  const IntervalOf<T> simple{-(size * width), size * width};
  const auto is_rounding = width < T(0x1p-40) * other_size;
  if (all(is_rounding)) return simple;
  EnclosureOf<T> polynomial = e;
  polynomial.low = polynomial.high = T(0.0);
  return select(is_rounding, simple, times(range(polynomial, quadratic), interval));
}

/// (A + Q_A + α)(B + Q_B + β) with A, B linear: A·B is Σ b_i A_i B_i − Σ b_i b_j ΔA ΔB exactly, A·Q_B is
/// taken with the mean of A, the rest goes into the interval.
template <typename T>
HWY_INLINE EnclosureOf<T> operator*(const EnclosureOf<T>& a, const EnclosureOf<T>& b) {
  const T mean_a = (a.linear[0] + a.linear[1] + a.linear[2]) * T(1.0 / 3);
  const T mean_b = (b.linear[0] + b.linear[1] + b.linear[2]) * T(1.0 / 3);
  EnclosureOf<T> product;
  T spread_a(0.0), spread_b(0.0);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    product.linear[k] = a.linear[k] * b.linear[k];
    product.quadratic[k] = mean_a * b.quadratic[k] + mean_b * a.quadratic[k] -
                           (a.linear[next] - a.linear[k]) * (b.linear[next] - b.linear[k]);
    spread_a = most(spread_a, absolute(a.linear[k] - mean_a));
    spread_b = most(spread_b, absolute(b.linear[k] - mean_b));
  }
  const IntervalOf<T> qa = quadratic_range(a), qb = quadratic_range(b);
  const T size_a = most(-qa.low, qa.high), size_b = most(-qb.low, qb.high);
  const T rest = spread_a * size_b + spread_b * size_a + size_a * size_b;

  // The polynomial parts times the other's interval, and the intervals times each other.
  const T magnitude_a = magnitude(a), magnitude_b = magnitude(b);
  const IntervalOf<T> alpha{a.low, a.high}, beta{b.low, b.high};
  const IntervalOf<T> ab = by_interval(a, magnitude_a, qa, beta, magnitude_b);
  const IntervalOf<T> ba = by_interval(b, magnitude_b, qb, alpha, magnitude_a), both = times(alpha, beta);
  product.low = ab.low + ba.low + both.low - rest;
  product.high = ab.high + ba.high + both.high + rest;
  widen(product, magnitude_a * magnitude_b);
  return product;
}

/// max(0, a): of three enclosures the one with the narrowest interval.
template <typename T>
HWY_INLINE EnclosureOf<T> positive_part(const EnclosureOf<T>& a) {
  const T zero(0.0);
  const IntervalOf<T> bend = quadratic_range(a), values = range(a, bend);
  const auto is_lit = zero <= values.low, is_dark = values.high <= zero;
  if (all(is_lit)) return a;

  // Linear through the corners, with the kink below.
  T kink(0.0);
  EnclosureOf<T> straight;
  for (std::size_t k = 0; k < 3; ++k) {
    const T s = a.linear[k], t = a.linear[(k + 1) % 3];
    kink = most(kink, select(s * t < zero, -(s * t) / (absolute(s) + absolute(t)), zero));
    straight.linear[k] = most(zero, s);
  }
  const T low = least(zero, bend.low + a.low), high = most(zero, bend.high + a.high);
  const T width = kink + high - low;
  straight.low = low - kink, straight.high = high;

  EnclosureOf<T> stretched = a;  // Where it dips below 0 only a little.
  stretched.high = stretched.high - values.low;
  const EnclosureOf<T> dark = anything_in<T>({zero, values.high});  // Almost everywhere.
  const T depth = -values.low;
  EnclosureOf<T> result = select((depth <= width) & (depth <= values.high), stretched,
                                 select(values.high <= width, dark, straight));
  widen(result, magnitude(a));
  return select(is_lit, a, select(is_dark, EnclosureOf<T>{}, result));
}

/// x^exponent, given 1/x.
template <typename T>
HWY_INLINE T power_of(T x, T inverse, double exponent) {
  if (exponent == -0.5) return root(inverse);
  if (exponent == -1.0) return inverse;
  if (exponent == -1.5) return inverse * root(inverse);
  return power_of(x, exponent);
}

/// x^exponent and its derivatives.
template <typename T>
struct PowerDerivatives {
  T value, slope, bend;
};

template <typename T>
HWY_INLINE PowerDerivatives<T> derivatives_of_power(T x, double exponent) {
  const T inverse = T(1.0) / x, value = power_of(x, inverse, exponent), slope = T(exponent) * value * inverse;
  return {value, slope, T(exponent - 1) * slope * inverse};
}

/// a^exponent for exponent < 0; a must be positive: `range(a).low > 0`.
///
/// h(ℓ + y) with ℓ linear and y = quadratic part + interval. Over ℓ: the interpolated corner values minus
/// half of h'' at the mean times the variance Σ b_i b_j Δ², the deviation of h'' into the interval. Over y:
/// h' at the mean, the deviation of h' into the interval. h is convex and decreasing, h' and h'' are
/// monotonic.
template <typename T>
HWY_INLINE EnclosureOf<T> power(const EnclosureOf<T>& a, double exponent) {
  const T zero(0.0), half(0.5);
  const T smallest = least(a.linear[0], a.linear[1], a.linear[2]);
  const T largest = most(a.linear[0], a.linear[1], a.linear[2]);
  const IntervalOf<T> quadratic = quadratic_range(a), values = range(a, quadratic);
  const T low = least(values.low, smallest), high = most(values.high, largest);
  const auto at_low = derivatives_of_power(low, exponent), at_high = derivatives_of_power(high, exponent);
  const auto at_mean = derivatives_of_power((a.linear[0] + a.linear[1] + a.linear[2]) * T(1.0 / 3), exponent);

  EnclosureOf<T> result;
  for (std::size_t k = 0; k < 3; ++k) {
    const T step = a.linear[(k + 1) % 3] - a.linear[k];
    result.linear[k] = power_of(a.linear[k], T(1.0) / a.linear[k], exponent);
    result.quadratic[k] = at_mean.slope * a.quadratic[k] - half * at_mean.bend * step * step;
  }
  const T variance = T(0.25) * (largest - smallest) * (largest - smallest);
  const IntervalOf<T> y{quadratic.low + a.low, quadratic.high + a.high};
  const IntervalOf<T> deviation = times<T>({at_low.slope - at_mean.slope, at_high.slope - at_mean.slope}, y);
  result.low =
      at_mean.slope * a.high + least(zero, deviation.low) - half * (at_low.bend - at_mean.bend) * variance;
  result.high =
      at_mean.slope * a.low + most(zero, deviation.high) + half * (at_mean.bend - at_high.bend) * variance;
  const T stretch = T(1.0) + (high - low) / low;
  widen(result, T(4 * (1 - exponent) * (1 - exponent)) * at_low.value * stretch * stretch);
  return result;
}

}  // namespace
}  // namespace lambake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
