#include "lambake/shading/enclosure.h"

namespace lambake {
namespace {

Interval times(const Interval& a, const Interval& b) {
  const double products[] = {a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high};
  return {*std::min_element(products, products + 4), *std::max_element(products, products + 4)};
}

/// x^exponent, given 1/x.
double power_of(double x, double inverse, double exponent) {
  if (exponent == -0.5) return std::sqrt(inverse);
  if (exponent == -1.0) return inverse;
  if (exponent == -1.5) return inverse * std::sqrt(inverse);
  return std::pow(x, exponent);
}

}  // namespace

Enclosure operator+(const Enclosure& a, const Enclosure& b) {
  Enclosure sum;
  for (std::size_t k = 0; k < 3; ++k) {
    sum.linear[k] = a.linear[k] + b.linear[k];
    sum.quadratic[k] = a.quadratic[k] + b.quadratic[k];
  }
  sum.low = a.low + b.low, sum.high = a.high + b.high;
  widen(sum, magnitude(a) + magnitude(b));
  return sum;
}

Enclosure operator*(double s, const Enclosure& a) {
  Enclosure scaled;
  for (std::size_t k = 0; k < 3; ++k)
    scaled.linear[k] = s * a.linear[k], scaled.quadratic[k] = s * a.quadratic[k];
  scaled.low = s * (s < 0 ? a.high : a.low), scaled.high = s * (s < 0 ? a.low : a.high);
  widen(scaled, std::abs(s) * magnitude(a));
  return scaled;
}

// (A + Q_A + α)(B + Q_B + β) with A, B linear: A·B is Σ b_i A_i B_i − Σ b_i b_j ΔA ΔB exactly, A·Q_B is
// taken with the mean of A, the rest goes into the interval.
Enclosure operator*(const Enclosure& a, const Enclosure& b) {
  const double mean_a = (a.linear[0] + a.linear[1] + a.linear[2]) / 3;
  const double mean_b = (b.linear[0] + b.linear[1] + b.linear[2]) / 3;
  Enclosure product;
  double spread_a = 0, spread_b = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    product.linear[k] = a.linear[k] * b.linear[k];
    product.quadratic[k] = -(a.linear[next] - a.linear[k]) * (b.linear[next] - b.linear[k]) +
                           mean_a * b.quadratic[k] + mean_b * a.quadratic[k];
    spread_a = std::max(spread_a, std::abs(a.linear[k] - mean_a));
    spread_b = std::max(spread_b, std::abs(b.linear[k] - mean_b));
  }
  const Interval qa = quadratic_range(a), qb = quadratic_range(b);
  const double size_a = std::max(-qa.low, qa.high), size_b = std::max(-qb.low, qb.high);
  const double rest = spread_a * size_b + spread_b * size_a + size_a * size_b;

  // The polynomial parts times the other's interval, and the intervals times each other.
  const double magnitude_a = magnitude(a), magnitude_b = magnitude(b);
  const auto by_interval = [](const Enclosure& e, double size, const Interval& quadratic,
                              const Interval& interval, double other_size) {
    const double width = interval.high - interval.low;
    if (width < 0x1p-40 * other_size) return Interval{-size * width, size * width};  // roundings alone
    Enclosure polynomial = e;
    polynomial.low = polynomial.high = 0;
    return times(range(polynomial, quadratic), interval);
  };
  const Interval alpha{a.low, a.high}, beta{b.low, b.high};
  const Interval ab = by_interval(a, magnitude_a, qa, beta, magnitude_b);
  const Interval ba = by_interval(b, magnitude_b, qb, alpha, magnitude_a), both = times(alpha, beta);
  product.low = ab.low + ba.low + both.low - rest;
  product.high = ab.high + ba.high + both.high + rest;
  widen(product, magnitude_a * magnitude_b);
  return product;
}

Enclosure positive_part(const Enclosure& a) {
  const Interval bend = quadratic_range(a), values = range(a, bend);
  if (values.low >= 0) return a;
  if (values.high <= 0) return {};

  // Three enclosures; the one with the narrowest interval. Linear through the corners, with the kink below:
  double kink = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double s = a.linear[k], t = a.linear[(k + 1) % 3];
    if (s * t < 0) kink = std::max(kink, -s * t / (std::abs(s) + std::abs(t)));
  }
  const double low = std::min(0.0, bend.low + a.low), high = std::max(0.0, bend.high + a.high);
  const double width_of_kink = kink + high - low;

  Enclosure result = a;
  if (-values.low <= width_of_kink && -values.low <= values.high) {
    result.high += -values.low;  // a itself, where it dips below 0 only a little
  } else if (values.high <= width_of_kink) {
    result = anything_in({0, values.high});  // almost everywhere dark
  } else {
    for (std::size_t k = 0; k < 3; ++k) result.linear[k] = std::max(0.0, a.linear[k]);
    result.quadratic = {};
    result.low = low - kink, result.high = high;
  }
  widen(result, magnitude(a));
  return result;
}

// h(ℓ + y) with ℓ linear and y = quadratic part + interval. Over ℓ: the interpolated corner values minus half
// of h'' at the mean times the variance Σ b_i b_j Δ², the deviation of h'' into the interval. Over y: h' at
// the mean, the deviation of h' into the interval. h is convex and decreasing, h' and h'' are monotonic.
Enclosure power(const Enclosure& a, double exponent) {
  const double least = std::min({a.linear[0], a.linear[1], a.linear[2]});
  const double most = std::max({a.linear[0], a.linear[1], a.linear[2]});
  const Interval quadratic = quadratic_range(a), values = range(a, quadratic);
  const double low = std::min(values.low, least), high = std::max(values.high, most);
  struct Derivatives {
    double value, slope, bend;
  };
  const auto derivatives = [&](double x) {
    const double inverse = 1 / x, value = power_of(x, inverse, exponent), slope = exponent * value * inverse;
    return Derivatives{value, slope, (exponent - 1) * slope * inverse};
  };
  const Derivatives at_low = derivatives(low), at_high = derivatives(high);
  const Derivatives at_mean = derivatives((a.linear[0] + a.linear[1] + a.linear[2]) / 3);

  Enclosure result;
  for (std::size_t k = 0; k < 3; ++k) {
    const double step = a.linear[(k + 1) % 3] - a.linear[k];
    result.linear[k] = power_of(a.linear[k], 1 / a.linear[k], exponent);
    result.quadratic[k] = at_mean.slope * a.quadratic[k] - 0.5 * at_mean.bend * step * step;
  }
  const double variance = 0.25 * (most - least) * (most - least);
  const Interval y{quadratic.low + a.low, quadratic.high + a.high};
  const Interval deviation = times({at_low.slope - at_mean.slope, at_high.slope - at_mean.slope}, y);
  result.low =
      at_mean.slope * a.high + std::min(0.0, deviation.low) - 0.5 * (at_low.bend - at_mean.bend) * variance;
  result.high =
      at_mean.slope * a.low + std::max(0.0, deviation.high) + 0.5 * (at_mean.bend - at_high.bend) * variance;
  const double stretch = 1 + (high - low) / low;
  widen(result, 4 * at_low.value * (1 - exponent) * (1 - exponent) * stretch * stretch);
  return result;
}

}  // namespace lambake
