#include "lambake/io/gltf/color.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <limits>

#include "lambake/core/parallel.h"

namespace lambake {
namespace {

constexpr std::size_t block_size = 16384;

float clamped(float channel) {
  return channel < 0 ? 0.0f : channel > 1 ? 1.0f : channel;
}

template <typename Integer>
constexpr float steps_of = std::numeric_limits<Integer>::max();

/// @param channel  in [0,1].
template <typename Integer>
Integer to_integer(float channel) {
  return static_cast<Integer>(channel * steps_of<Integer> + 0.5f);
}

/// Calls `body(i, {r, g, b, a})` for each colour, after NaN, range and clamp; fills the counts of `out`.
template <typename Body>
void for_each_clamped(std::span<const LinearRgb> colors, std::span<const float> opacities, float slack,
                      bool is_clamped, EncodedColors& out, const Body& body) {
  std::atomic<std::size_t> clipped{0}, negative{0};
  parallel_blocks(colors.size(), block_size, [&](std::size_t begin, std::size_t end) {
    std::size_t n_clipped = 0, n_negative = 0;
    for (std::size_t i = begin; i < end; ++i) {
      std::array<float, 4> c{colors[i].r, colors[i].g, colors[i].b, opacities.empty() ? 1.0f : opacities[i]};
      bool is_above = false, is_below = false;
      for (float& channel : c) {
        if (!(channel == channel)) channel = 0;
        is_above |= channel > 1 + slack;
        is_below |= channel < -slack;
        if (is_clamped) channel = clamped(channel);
      }
      n_clipped += is_above ? 1 : 0;
      n_negative += is_below ? 1 : 0;
      body(i, c);
    }
    clipped += n_clipped;
    negative += n_negative;
  });
  if (!is_clamped) return;
  out.losses = {.n_above = clipped, .n_below = negative, .brightest = clipped > 0 ? brightest_of(colors) : 0};
}

template <typename Integer>
void encode_normalized(std::span<const LinearRgb> colors, std::span<const float> opacities,
                       EncodedColors& out) {
  out.bytes.resize(colors.size() * 4 * sizeof(Integer));
  out.is_normalized = true;
  for_each_clamped(colors, opacities, 0.5f / steps_of<Integer>, true, out,
                   [&](std::size_t i, const std::array<float, 4>& c) {
                     std::array<Integer, 4> stored;
                     for (std::size_t k = 0; k < 4; ++k) stored[k] = to_integer<Integer>(c[k]);
                     std::memcpy(out.bytes.data() + i * sizeof stored, stored.data(), sizeof stored);
                   });
}

}  // namespace

EncodedColors encode_colors(std::span<const LinearRgb> colors, std::span<const float> opacities,
                            const ColorEncoding& encoding) {
  EncodedColors out;
  out.count = colors.size();
  switch (encoding.storage) {
    case ColorStorage::u8:
      out.component_type = gltf::unsigned_byte;
      encode_normalized<std::uint8_t>(colors, opacities, out);
      break;
    case ColorStorage::u16:
      out.component_type = gltf::unsigned_short;
      encode_normalized<std::uint16_t>(colors, opacities, out);
      break;
    case ColorStorage::f32: {
      const std::size_t n_channels = opacities.empty() ? 3 : 4;
      out.type = opacities.empty() ? "VEC3" : "VEC4";
      out.bytes.resize(colors.size() * n_channels * sizeof(float));
      for_each_clamped(colors, opacities, 1e-6f, encoding.is_clamped, out,
                       [&](std::size_t i, const std::array<float, 4>& c) {
                         std::memcpy(out.bytes.data() + i * n_channels * sizeof(float), c.data(),
                                     n_channels * sizeof(float));
                       });
      break;
    }
  }
  return out;
}

LinearRgb encoded_color(const LinearRgb& color, const ColorEncoding& encoding) {
  const auto channel = [&](float value) {
    if (!(value == value)) return 0.0f;
    switch (encoding.storage) {
      case ColorStorage::u8:
        return static_cast<float>(to_integer<std::uint8_t>(clamped(value))) / steps_of<std::uint8_t>;
      case ColorStorage::u16:
        return static_cast<float>(to_integer<std::uint16_t>(clamped(value))) / steps_of<std::uint16_t>;
      case ColorStorage::f32:
        break;
    }
    return encoding.is_clamped ? clamped(value) : value;
  };
  return {channel(color.r), channel(color.g), channel(color.b)};
}

}  // namespace lambake
