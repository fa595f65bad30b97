#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

namespace lambake {

/// A linear RGB colour (Rec. 709 primaries), unbounded above. Everything inside lambake is linear.
struct LinearRgb {
  float r = 0, g = 0, b = 0;

  friend constexpr bool operator==(const LinearRgb&, const LinearRgb&) = default;
  constexpr LinearRgb& operator+=(const LinearRgb& o) {
    r += o.r, g += o.g, b += o.b;
    return *this;
  }
};

constexpr LinearRgb operator+(LinearRgb a, const LinearRgb& b) {
  return a += b;
}
constexpr LinearRgb operator-(const LinearRgb& a, const LinearRgb& b) {
  return {a.r - b.r, a.g - b.g, a.b - b.b};
}
/// Componentwise: light of colour `a` reflected by an albedo `b`.
constexpr LinearRgb operator*(const LinearRgb& a, const LinearRgb& b) {
  return {a.r * b.r, a.g * b.g, a.b * b.b};
}
constexpr LinearRgb operator*(const LinearRgb& a, float s) {
  return {a.r * s, a.g * s, a.b * s};
}
constexpr LinearRgb operator*(float s, const LinearRgb& a) {
  return a * s;
}

inline glm::dvec3 to_double(const LinearRgb& c) {
  return {c.r, c.g, c.b};
}

inline bool is_finite(const LinearRgb& c) {
  return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b);
}

/// An sRGB-encoded colour of 8 bits a channel, as screens, PNG and PLY have it.
struct Srgb8 {
  std::uint8_t r = 0, g = 0, b = 0;
  friend constexpr bool operator==(const Srgb8&, const Srgb8&) = default;
};

/// The sRGB curve of IEC 61966-2-1, one channel: linear in [0,1] to encoded in [0,1]. Not clamped;
/// the straight piece continues below 0.
template <typename Real>
Real srgb_encode(Real linear) {
  return linear <= Real(0.0031308) ? Real(12.92) * linear
                                   : Real(1.055) * std::pow(linear, Real(1) / Real(2.4)) - Real(0.055);
}

/// Inverse of srgb_encode.
template <typename Real>
Real srgb_decode(Real encoded) {
  return encoded <= Real(0.04045) ? encoded / Real(12.92)
                                  : std::pow((encoded + Real(0.055)) / Real(1.055), Real(2.4));
}

/// srgb_decode() of the 256 values that a byte has.
inline const std::array<float, 256> linear_of_byte = [] {
  std::array<float, 256> linear{};
  for (std::size_t i = 0; i < linear.size(); ++i)
    linear[i] = static_cast<float>(srgb_decode(double(i) / 255));
  return linear;
}();

/// Where colours are compared: as they are, or as a screen shows them (sRGB-encoded, clamped to [0,1]).
enum class ErrorSpace { linear, display };

/// A linear channel as it is compared in `space`.
template <typename Real>
Real compared(Real linear, ErrorSpace space) {
  return space == ErrorSpace::linear ? linear : srgb_encode(std::clamp(linear, Real(0), Real(1)));
}

/// The linear channel, in [0,1] on screen, that compared() maps there.
template <typename Real>
Real compared_inverse(Real value, ErrorSpace space) {
  return space == ErrorSpace::linear ? value : srgb_decode(std::clamp(value, Real(0), Real(1)));
}

/// Encoded, clamped to [0,1] and rounded to the nearest of 256 steps; NaN becomes 0.
inline std::uint8_t srgb8_channel(float linear) {
  if (!(linear > 0.0f)) return 0;
  if (linear >= 1.0f) return 255;
  return static_cast<std::uint8_t>(srgb_encode(linear) * 255.0f + 0.5f);
}

inline Srgb8 to_srgb8(const LinearRgb& c) {
  return {srgb8_channel(c.r), srgb8_channel(c.g), srgb8_channel(c.b)};
}

inline LinearRgb to_linear(const Srgb8& c) {
  return {srgb_decode(c.r / 255.0f), srgb_decode(c.g / 255.0f), srgb_decode(c.b / 255.0f)};
}

}  // namespace lambake
