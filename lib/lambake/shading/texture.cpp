#include "lambake/shading/texture.h"

#include <cmath>
#include <cstdint>

namespace lambake {
namespace {

/// Brings a coordinate into [0,1] (repeat: [0,1)), in double so that large coordinates keep their fraction.
double wrap(double x, TextureWrap mode) {
  if (!std::isfinite(x)) return 0;
  switch (mode) {
    case TextureWrap::repeat:
      return x - std::floor(x);
    case TextureWrap::clamp_to_edge:
      return glm::clamp(x, 0.0, 1.0);
    case TextureWrap::mirrored_repeat: {
      const double two = x - 2 * std::floor(x / 2);
      return two <= 1 ? two : 2 - two;
    }
  }
  return 0;
}

/// A texel index at most one outside [0, size), as bilinear filtering asks for, brought inside.
std::uint32_t wrap_index(std::int64_t i, std::uint32_t size, TextureWrap mode) {
  const std::int64_t n = size;
  if (mode == TextureWrap::repeat) return static_cast<std::uint32_t>(i < 0 ? i + n : (i >= n ? i - n : i));
  return static_cast<std::uint32_t>(
      glm::clamp<std::int64_t>(i, 0, n - 1));  // a mirror repeats its edge texel
}

/// Any texel index brought inside [0, size).
std::uint32_t wrap_any_index(std::int64_t i, std::uint32_t size, TextureWrap mode) {
  const std::int64_t n = size;
  if (mode == TextureWrap::clamp_to_edge)
    return static_cast<std::uint32_t>(glm::clamp<std::int64_t>(i, 0, n - 1));
  const std::int64_t period = mode == TextureWrap::repeat ? n : 2 * n;
  const std::int64_t at = (i % period + period) % period;
  return static_cast<std::uint32_t>(at < n ? at : 2 * n - 1 - at);
}

}  // namespace

glm::vec4 texel_of_plane(const Image& image, const Texture& texture, std::int64_t i, std::int64_t j) {
  const std::size_t row = wrap_any_index(j, image.height, texture.wrap_t);
  return image.pixel(row * image.width + wrap_any_index(i, image.width, texture.wrap_s));
}

glm::vec4 sample_texture(const Scene& scene, const Texture& texture, const glm::vec2& uv) {
  const Image& image = scene.images[texture.image];
  if (image.n_pixels() == 0) return glm::vec4(1);
  const glm::dvec3 placed = glm::dmat3(texture.transform) * glm::dvec3(uv, 1);
  const double x = wrap(placed.x, texture.wrap_s) * image.width;
  const double y = wrap(placed.y, texture.wrap_t) * image.height;
  const auto texel = [&](std::int64_t i, std::int64_t j) {
    const std::size_t row = wrap_index(j, image.height, texture.wrap_t);
    return image.pixel(row * image.width + wrap_index(i, image.width, texture.wrap_s));
  };
  if (texture.filter == TextureFilter::nearest)
    return texel(static_cast<std::int64_t>(x), static_cast<std::int64_t>(y));
  const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);  // texel centres lie at halves
  const std::int64_t i = static_cast<std::int64_t>(left), j = static_cast<std::int64_t>(top);
  const float s = static_cast<float>(x - 0.5 - left), t = static_cast<float>(y - 0.5 - top);
  const glm::vec4 upper = glm::mix(texel(i, j), texel(i + 1, j), s);
  const glm::vec4 lower = glm::mix(texel(i, j + 1), texel(i + 1, j + 1), s);
  return glm::mix(upper, lower, t);
}

}  // namespace lambake
