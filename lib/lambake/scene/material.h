#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/type_precision.hpp>
#include <limits>
#include <string>
#include <vector>

#include "lambake/core/color.h"

namespace lambake {

/// Pixels of a texture, row by row from the top. W×H, as bytes or as floats.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<glm::vec4> pixels;     ///< W·H, or none; rgb linear, a in [0,1].
  std::vector<glm::u8vec4> bytes{};  ///< W·H, or none: rgb sRGB-encoded and a, of 255.
  /// The bytes of the PNG or JPEG that the pixels are from, to be written again; or none.
  std::string file{};

  std::size_t n_pixels() const { return bytes.empty() ? pixels.size() : bytes.size(); }
  /// Linear RGB and opacity of a pixel, row · width + column.
  glm::vec4 pixel(std::size_t i) const {
    if (bytes.empty()) return pixels[i];
    const glm::u8vec4 b = bytes[i];
    return {linear_of_byte[b.r], linear_of_byte[b.g], linear_of_byte[b.b], float(b.a) / 255.0f};
  }
};

enum class TextureWrap { repeat, clamp_to_edge, mirrored_repeat };
enum class TextureFilter { nearest, linear };

/// How an image is looked up.
struct Texture {
  std::uint32_t image = 0;  ///< Index into Scene::images.
  TextureWrap wrap_s = TextureWrap::repeat, wrap_t = TextureWrap::repeat;
  TextureFilter filter = TextureFilter::linear;
  int texcoord_set = 0;       ///< Index into Mesh::texcoords.
  glm::mat3 transform{1.0f};  ///< Applied to (u, v, 1): KHR_texture_transform.
};

inline constexpr std::uint32_t no_texture = std::numeric_limits<std::uint32_t>::max();

/// What opacities mean, as glTF has it: nothing, whether there is anything to see, or how much of it.
enum class AlphaMode { opaque, mask, blend };

/// A Lambertian material. Albedo = base_color ⊗ texture ⊗ vertex colour; each factor in [0,1].
struct Material {
  std::string name;
  LinearRgb base_color{1, 1, 1};
  float opacity = 1;
  std::uint32_t base_color_texture = no_texture;  ///< Index into Scene::textures.
  LinearRgb emission{0, 0, 0};                    ///< Unbounded above.
  std::uint32_t emission_texture = no_texture;    ///< Multiplies `emission`.
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;    ///< For AlphaMode::mask: less than this is not drawn.
  bool is_double_sided = true;  ///< Otherwise faces seen from behind are not drawn.
  bool is_unlit = false;        ///< Shows its base colour as it is; takes no light, shows no emission.
};

/// What it shows of its emission, but for the texture.
inline LinearRgb emission_of(const Material& material) {
  return material.is_unlit ? LinearRgb{0, 0, 0} : material.emission;
}
inline bool has_emission(const Material& material) {
  return !(emission_of(material) == LinearRgb{0, 0, 0});
}

inline bool has_texture(const Material& material) {
  return material.base_color_texture != no_texture || material.emission_texture != no_texture;
}

}  // namespace lambake
