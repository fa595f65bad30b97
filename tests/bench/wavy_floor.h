#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "lambake/scene/scene.h"

/// What the benchmarks measure on: a floor of gentle waves, 2×2 wide, and lamps spread over it.
namespace lambake {

/// side² vertices, 2·(side − 1)² triangles, no normals.
/// @param ripples  steepest slope of ripples two dozen vertices long on top of the waves.
inline Mesh wavy_floor(std::uint32_t side, float ripples = 0) {
  Mesh m;
  for (std::uint32_t i = 0; i < side; ++i)
    for (std::uint32_t j = 0; j < side; ++j) {
      const float x = 2 * static_cast<float>(i) / static_cast<float>(side) - 1;
      const float z = 2 * static_cast<float>(j) / static_cast<float>(side) - 1;
      const float turn = 6.2831853f / 24, height = ripples * 2 / (static_cast<float>(side) * turn);
      const float ripple =
          height * std::sin(turn * static_cast<float>(i)) * std::cos(turn * static_cast<float>(j));
      m.positions.emplace_back(x, 0.1f * std::sin(3 * x) * std::cos(2.5f * z) + ripple, z);
    }
  for (std::uint32_t i = 0; i + 1 < side; ++i)
    for (std::uint32_t j = 0; j + 1 < side; ++j) {
      const std::uint32_t a = i * side + j, b = a + 1, c = a + side, d = c + 1;
      m.triangles.emplace_back(a, b, d);
      m.triangles.emplace_back(a, d, c);
    }
  return m;
}

/// n point lights of falloff 1/d² and random colour, together about as bright as one sun.
inline std::vector<Light> lamps_over_the_floor(std::size_t n) {
  std::mt19937 engine(3);
  const auto random = [&](float low, float high) {
    return low + (high - low) * static_cast<float>(engine()) / 4294967296.0f;
  };
  std::vector<Light> lights(n);
  for (Light& light : lights) {
    const float s = 2.0f / static_cast<float>(n);
    light.type = LightType::point;
    light.position = {random(-1, 1), random(0.2f, 0.8f), random(-1, 1)};
    light.intensity = {random(0, s), random(0, s), random(0, s)};
  }
  return lights;
}

}  // namespace lambake
