#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <random>

/// Random numbers that are the same on every machine.
namespace lambake {

struct Random {
  std::mt19937_64 engine;
  double operator()(double low, double high) {
    return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
  }
  int below(int n) { return static_cast<int>(engine() % static_cast<std::uint64_t>(n)); }
  /// Spread over orders of magnitude.
  double scale(double low, double high) { return std::exp((*this)(std::log(low), std::log(high))); }
  glm::dvec3 unit() {
    for (;;) {
      const glm::dvec3 v((*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1));
      const double length = glm::length(v);
      if (length > 0.1 && length <= 1) return v / length;
    }
  }
};

}  // namespace lambake
