#include "gallery_textures.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <numbers>

namespace lambake {
namespace {

/// A number in [0,1) for a point of the integer lattice.
float lattice_noise(std::uint32_t x, std::uint32_t y) {
  std::uint32_t h = x * 0x9E3779B1U ^ y * 0x85EBCA77U;
  h = (h ^ h >> 15) * 0x2C1B3C6DU;
  h = (h ^ h >> 12) * 0x297A2D39U;
  return static_cast<float>((h ^ h >> 15) >> 8) / 16777216.0f;
}

/// Smooth noise in [0,1) over the unit square with n_x × n_y cells; it tiles.
float tiling_noise(glm::vec2 p, std::uint32_t n_x, std::uint32_t n_y, std::uint32_t seed) {
  p *= glm::vec2(static_cast<float>(n_x), static_cast<float>(n_y));
  const glm::vec2 cell = glm::floor(p), f = p - cell, s = f * f * (3.0f - 2.0f * f);
  const auto x = static_cast<std::uint32_t>(cell.x), y = static_cast<std::uint32_t>(cell.y);
  const auto at = [&](std::uint32_t dx, std::uint32_t dy) {
    return lattice_noise((x + dx) % n_x + 977 * seed, (y + dy) % n_y + 131 * seed);
  };
  return glm::mix(glm::mix(at(0, 0), at(1, 0), s.x), glm::mix(at(0, 1), at(1, 1), s.x), s.y);
}

template <typename Color>
Picture paint(std::uint32_t width, std::uint32_t height, const Color& color) {
  Picture picture{width, height, {}};
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const glm::vec3 c = color(glm::vec2((static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                                          (static_cast<float>(y) + 0.5f) / static_cast<float>(height)));
      picture.pixels.push_back({c.r, c.g, c.b});
    }
  return picture;
}

}  // namespace

Picture wood_planks() {
  constexpr std::uint32_t n_planks = 8;
  return paint(256, 256, [](const glm::vec2& p) {
    const float across = p.x * n_planks;
    const auto plank = static_cast<std::uint32_t>(across);
    const float inside = across - static_cast<float>(plank);
    const float along = p.y + lattice_noise(plank, 7);  // Each plank ends somewhere else.
    const auto board = static_cast<std::uint32_t>(along) % 2;
    const float end = along - std::floor(along);
    const float grain = tiling_noise(p, 64, 4, 1) * 0.6f + tiling_noise(p, 128, 8, 2) * 0.4f;
    const float tone = 0.75f + 0.35f * lattice_noise(plank + 17 * board, 3) + 0.25f * (grain - 0.5f);
    const float gap = std::min({inside, 1 - inside, end * 12, (1 - end) * 12});
    const float dark = gap < 0.045f ? 0.45f : 1.0f;
    return glm::vec3(0.42f, 0.24f, 0.12f) * tone * dark;
  });
}

Picture marble_veins() {
  return paint(128, 128, [](const glm::vec2& p) {
    const float warp =
        tiling_noise(p, 3, 3, 5) + 0.5f * tiling_noise(p, 6, 6, 6) + 0.25f * tiling_noise(p, 12, 12, 7);
    const float vein = std::abs(std::sin(std::numbers::pi_v<float> * (2 * p.x + 2 * p.y + 2.2f * warp)));
    const float darkness = std::exp(-14 * vein);
    return glm::mix(glm::vec3(0.86f, 0.84f, 0.80f), glm::vec3(0.33f, 0.34f, 0.38f), 0.75f * darkness) *
           (0.93f + 0.07f * tiling_noise(p, 24, 24, 8));
  });
}

Picture dusk_painting() {
  return paint(192, 144, [](const glm::vec2& p) {
    const glm::vec2 q(p.x * 4 / 3, p.y);
    glm::vec3 color = glm::mix(glm::vec3(0.10f, 0.12f, 0.40f), glm::vec3(0.95f, 0.45f, 0.18f), p.y * 1.25f);
    const float to_sun = glm::distance(q, glm::vec2(0.88f, 0.52f));
    if (to_sun < 0.17f) color = {1.0f, 0.80f, 0.35f};
    const float ridges[] = {0.62f, 0.74f, 0.87f};
    const glm::vec3 tones[] = {{0.42f, 0.14f, 0.28f}, {0.20f, 0.08f, 0.22f}, {0.05f, 0.04f, 0.11f}};
    for (int i = 0; i < 3; ++i) {
      const float phase = static_cast<float>(i) * 1.9f;
      const float ridge =
          ridges[i] + 0.045f * std::sin(7 * p.x + phase) + 0.03f * std::sin(17 * p.x + 2 * phase);
      if (p.y > ridge) color = tones[i];
    }
    return color;
  });
}

}  // namespace lambake
