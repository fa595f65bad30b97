#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <string>

namespace lambake {

/// 1234567 as "1,234,567".
inline std::string group_digits(std::size_t n) {
  std::string digits = std::to_string(n);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, 1, ',');
  return digits;
}

/// x rounded up to a multiple of 10^-decimals, so that an upper bound is still one; 1e-9 of x is forgiven.
inline double round_up(double x, int decimals) {
  const double scale = std::pow(10.0, decimals);
  return std::ceil(x * (1 - 1e-9) * scale) / scale;
}

/// An upper bound >= 0 in three significant digits that is one still.
inline std::string upper_bound_text(double x) {
  const int decimals = x > 0 ? 2 - static_cast<int>(std::floor(std::log10(x))) : 0;
  return fmt::format("{:.3g}", round_up(x, decimals));
}

}  // namespace lambake
