#include "lambake/shading/finish.h"

#include <algorithm>
#include <cmath>

#include "lambake/shading/texture.h"

namespace lambake {
namespace {

/// The texels whose values a bilinear look-up within [low, high] can meet, looked up one by one as long as
/// they are few; otherwise `whole`.
TexelRange texel_range(const Scene& scene, const Texture& texture, const glm::dvec2& low,
                       const glm::dvec2& high, const TexelRange& whole) {
  constexpr double most_texels = 4096;
  // A float look-up between two texels may leave their range by a rounding.
  constexpr double room = 1e-6;
  const Image& image = scene.images[texture.image];
  const glm::dvec2 size(image.width, image.height);
  const glm::dvec2 first = glm::floor(low * size - 0.51), last = glm::ceil(high * size + 0.51);
  const glm::dvec2 count = last - first + 1.0;
  // Far out, where a float is coarser than a texel, the whole is taken as well.
  const double farthest = std::max({-first.x, -first.y, last.x, last.y});
  if (!(count.x * count.y <= most_texels) || farthest > 1e5) return whole;
  TexelRange range{glm::dvec3(1e300), glm::dvec3(-1e300)};
  for (auto y = static_cast<std::int64_t>(first.y); y <= static_cast<std::int64_t>(last.y); ++y)
    for (auto x = static_cast<std::int64_t>(first.x); x <= static_cast<std::int64_t>(last.x); ++x) {
      const glm::dvec3 texel(texel_of_plane(image, texture, x, y));
      range.low = glm::min(range.low, texel), range.high = glm::max(range.high, texel);
    }
  range.low *= 1 - room, range.high *= 1 + room;
  return range;
}

TexelRange whole_range(const Scene& scene, const Texture& texture) {
  TexelRange range;
  const Image& image = scene.images[texture.image];
  if (image.n_pixels() == 0) return range;
  range = {glm::dvec3(1e300), glm::dvec3(-1e300)};
  for (std::size_t i = 0; i < image.n_pixels(); ++i) {
    const glm::dvec3 pixel(image.pixel(i));
    range.low = glm::min(range.low, pixel), range.high = glm::max(range.high, pixel);
  }
  range.low *= 1 - 1e-6, range.high *= 1 + 1e-6;
  return range;
}

}  // namespace

Finishes::Finishes(const Scene& scene) : scene_(scene) {
  for (const Texture& texture : scene.textures) whole_ranges_.push_back(whole_range(scene, texture));
}

bool Finishes::has_texture(const Mesh& mesh, std::size_t triangle) const {
  return lambake::has_texture(scene_.materials[mesh.material_of(triangle)]);
}

glm::dvec3 Finishes::texel_at(std::uint32_t texture, const Mesh& mesh, std::size_t triangle,
                              const glm::dvec3& b) const {
  const Texture& t = scene_.textures[texture];
  const std::vector<glm::vec2>& texcoords = mesh.texcoords[static_cast<std::size_t>(t.texcoord_set)];
  if (texcoords.empty()) return glm::dvec3(1);
  const glm::uvec3& v = mesh.triangles[triangle];
  const glm::dvec2 uv = b[0] * glm::dvec2(texcoords[v[0]]) + b[1] * glm::dvec2(texcoords[v[1]]) +
                        b[2] * glm::dvec2(texcoords[v[2]]);
  return glm::dvec3(sample_texture(scene_, t, glm::vec2(uv)));
}

Finish Finishes::at(const Mesh& mesh, std::size_t triangle, const glm::dvec3& b) const {
  const Material& m = scene_.materials[mesh.material_of(triangle)];
  Finish finish{to_double(m.base_color), glm::dvec3(0), m.is_unlit};
  if (m.base_color_texture != no_texture) finish.base *= texel_at(m.base_color_texture, mesh, triangle, b);
  if (m.is_unlit) return finish;
  finish.emission = to_double(m.emission);
  if (m.emission_texture != no_texture) finish.emission *= texel_at(m.emission_texture, mesh, triangle, b);
  return finish;
}

std::array<TexelCorners, 2> Finishes::texel_corners(const Mesh& mesh, std::size_t triangle) const {
  const Material& m = scene_.materials[mesh.material_of(triangle)];
  std::array<TexelCorners, 2> result;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::uint32_t texture = i == 0 ? m.base_color_texture : m.emission_texture;
    if (texture == no_texture) continue;
    const Texture& t = scene_.textures[texture];
    const std::vector<glm::vec2>& texcoords = mesh.texcoords[static_cast<std::size_t>(t.texcoord_set)];
    if (texcoords.empty()) continue;
    const Image& image = scene_.images[t.image];
    const glm::dvec2 size(image.width, image.height);
    const glm::dmat3 transform(t.transform);
    result[i].is_nearest = t.filter == TextureFilter::nearest;
    for (std::size_t c = 0; c < 3; ++c) {
      const glm::dvec2 uv(texcoords[mesh.triangles[triangle][static_cast<int>(c)]]);
      result[i].at[c] = size * glm::dvec2(transform * glm::dvec3(uv, 1));
      const glm::dvec2 off = 0x1p-24 * size *
                             (glm::abs(glm::dvec2(transform[0])) * std::abs(uv.x) +
                              glm::abs(glm::dvec2(transform[1])) * std::abs(uv.y));
      result[i].rounding = glm::max(result[i].rounding, off);
    }
  }
  return result;
}

TexelRange Finishes::texels_over(std::uint32_t texture, const Mesh& mesh, std::size_t triangle) const {
  const Texture& t = scene_.textures[texture];
  const std::vector<glm::vec2>& texcoords = mesh.texcoords[static_cast<std::size_t>(t.texcoord_set)];
  if (texcoords.empty()) return {};
  glm::dvec2 low(1e300), high(-1e300);
  for (int c = 0; c < 3; ++c) {
    const glm::dvec2 uv(glm::dmat3(t.transform) *
                        glm::dvec3(glm::dvec2(texcoords[mesh.triangles[triangle][c]]), 1.0));
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) return whole_ranges_[texture];
    low = glm::min(low, uv), high = glm::max(high, uv);
  }
  return texel_range(scene_, t, low, high, whole_ranges_[texture]);
}

FinishRange Finishes::over(const Mesh& mesh, std::size_t triangle) const {
  const Material& m = scene_.materials[mesh.material_of(triangle)];
  FinishRange range{to_double(m.base_color), to_double(m.base_color), glm::dvec3(0), glm::dvec3(0),
                    m.is_unlit};
  if (m.base_color_texture != no_texture) {
    const TexelRange texels = texels_over(m.base_color_texture, mesh, triangle);
    range.base_low *= texels.low, range.base_high *= texels.high;
  }
  if (m.is_unlit) return range;
  range.emission_low = range.emission_high = to_double(m.emission);
  if (m.emission_texture != no_texture) {
    const TexelRange texels = texels_over(m.emission_texture, mesh, triangle);
    range.emission_low *= texels.low, range.emission_high *= texels.high;
  }
  return range;
}

}  // namespace lambake
