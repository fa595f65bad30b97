#include "lambake/measure/surface.h"

#include <fmt/format.h>

#include "lambake/core/error.h"
#include "lambake/shading/texture.h"

namespace lambake {
namespace {

glm::dvec3 to_double(const LinearRgb& c) {
  return {c.r, c.g, c.b};
}

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
  Texture plain = texture;
  plain.transform = glm::mat3(1.0f);
  TexelRange range{glm::dvec3(1e300), glm::dvec3(-1e300)};
  for (double y = first.y; y <= last.y; ++y)
    for (double x = first.x; x <= last.x; ++x) {
      const glm::dvec3 texel(sample_texture(scene, plain, glm::vec2((glm::dvec2(x, y) + 0.5) / size)));
      range.low = glm::min(range.low, texel), range.high = glm::max(range.high, texel);
    }
  range.low *= 1 - room, range.high *= 1 + room;
  return range;
}

TexelRange whole_range(const Scene& scene, const Texture& texture) {
  TexelRange range;
  const Image& image = scene.images[texture.image];
  if (image.pixels.empty()) return range;
  range = {glm::dvec3(1e300), glm::dvec3(-1e300)};
  for (const glm::vec4& pixel : image.pixels)
    range.low = glm::min(range.low, glm::dvec3(pixel)), range.high = glm::max(range.high, glm::dvec3(pixel));
  range.low *= 1 - 1e-6, range.high *= 1 + 1e-6;
  return range;
}

}  // namespace

ComparedSurface::ComparedSurface(const Scene& scene, const BakedColors& baked)
    : scene_(scene),
      mesh_(mesh_of(scene, baked)),
      colors_(baked.colors),
      n_uncut_(mesh_.n_vertices() - std::min(baked.cuts.size(), mesh_.n_vertices())) {
  const auto check = [](const char* what, std::size_t found, std::size_t expected) {
    if (found != expected)
      throw InvalidScene(fmt::format("measure: {}: expected {}, found {}", what, expected, found));
  };
  check("vertex colours", colors_.size(), mesh_.n_vertices());
  check("vertex normals", mesh_.normals.size(), mesh_.n_vertices());
  if (!baked.cuts.empty()) check("vertices before the cuts", n_uncut_, scene.mesh.n_vertices());

  for (const Texture& texture : scene.textures) texture_ranges_.push_back(whole_range(scene, texture));
  cut_positions_.reserve(baked.cuts.size());
  cut_normals_.reserve(baked.cuts.size());
  for (const EdgeCut& cut : baked.cuts) {
    const auto value = [&](std::uint32_t v, const std::vector<glm::vec3>& uncut,
                           const std::vector<glm::dvec3>& made) {
      return v < n_uncut_ ? glm::dvec3(uncut[v]) : made[v - n_uncut_];
    };
    const double t = cut.t;
    cut_positions_.push_back((1 - t) * value(cut.a, mesh_.positions, cut_positions_) +
                             t * value(cut.b, mesh_.positions, cut_positions_));
    cut_normals_.push_back((1 - t) * value(cut.a, mesh_.normals, cut_normals_) +
                           t * value(cut.b, mesh_.normals, cut_normals_));
    if (mesh_.colors.empty()) continue;
    const auto albedo = [&](std::uint32_t v) {
      return v < n_uncut_ ? to_double(mesh_.colors[v]) : cut_albedos_[v - n_uncut_];
    };
    cut_albedos_.push_back((1 - t) * albedo(cut.a) + t * albedo(cut.b));
  }
}

Patch ComparedSurface::patch(std::size_t triangle) const {
  Patch patch;
  for (int c = 0; c < 3; ++c) {
    const std::uint32_t v = mesh_.triangles[triangle][c];
    const bool is_cut = v >= n_uncut_;
    patch.positions[c] = is_cut ? cut_positions_[v - n_uncut_] : glm::dvec3(mesh_.positions[v]);
    patch.normals[c] = is_cut ? cut_normals_[v - n_uncut_] : glm::dvec3(mesh_.normals[v]);
    if (!mesh_.colors.empty())
      patch.albedos[c] = is_cut ? cut_albedos_[v - n_uncut_] : to_double(mesh_.colors[v]);
    patch.colors[c] = to_double(colors_[v]);
  }
  return patch;
}

glm::dvec3 ComparedSurface::area_vector(const Patch& patch) {
  return glm::cross(patch.positions[1] - patch.positions[0], patch.positions[2] - patch.positions[0]);
}

bool ComparedSurface::has_texture(std::size_t triangle) const {
  const Material& m = material(triangle);
  return m.base_color_texture != no_texture || m.emission_texture != no_texture;
}

glm::dvec3 ComparedSurface::texel_at(std::uint32_t texture, std::size_t triangle, const glm::dvec3& b) const {
  const Texture& t = scene_.textures[texture];
  const std::vector<glm::vec2>& texcoords = mesh_.texcoords[static_cast<std::size_t>(t.texcoord_set)];
  if (texcoords.empty()) return glm::dvec3(1);
  const glm::uvec3& v = mesh_.triangles[triangle];
  const glm::dvec2 uv = b[0] * glm::dvec2(texcoords[v[0]]) + b[1] * glm::dvec2(texcoords[v[1]]) +
                        b[2] * glm::dvec2(texcoords[v[2]]);
  return glm::dvec3(sample_texture(scene_, t, glm::vec2(uv)));
}

Finish ComparedSurface::finish_at(std::size_t triangle, const glm::dvec3& b) const {
  const Material& m = material(triangle);
  Finish finish{to_double(m.base_color), glm::dvec3(0), m.is_unlit};
  if (m.base_color_texture != no_texture) finish.base *= texel_at(m.base_color_texture, triangle, b);
  if (m.is_unlit) return finish;
  finish.emission = to_double(m.emission);
  if (m.emission_texture != no_texture) finish.emission *= texel_at(m.emission_texture, triangle, b);
  return finish;
}

TexelRange ComparedSurface::texels_over(std::uint32_t texture, std::size_t triangle) const {
  const Texture& t = scene_.textures[texture];
  const std::vector<glm::vec2>& texcoords = mesh_.texcoords[static_cast<std::size_t>(t.texcoord_set)];
  if (texcoords.empty()) return {};
  glm::dvec2 low(1e300), high(-1e300);
  for (int c = 0; c < 3; ++c) {
    const glm::dvec2 uv(glm::dmat3(t.transform) *
                        glm::dvec3(glm::dvec2(texcoords[mesh_.triangles[triangle][c]]), 1.0));
    low = glm::min(low, uv), high = glm::max(high, uv);
  }
  return texel_range(scene_, t, low, high, texture_ranges_[texture]);
}

FinishRange ComparedSurface::finish_range(std::size_t triangle) const {
  const Material& m = material(triangle);
  FinishRange range{to_double(m.base_color), to_double(m.base_color), glm::dvec3(0), glm::dvec3(0),
                    m.is_unlit};
  if (m.base_color_texture != no_texture) {
    const TexelRange texels = texels_over(m.base_color_texture, triangle);
    range.base_low *= texels.low, range.base_high *= texels.high;
  }
  if (m.is_unlit) return range;
  range.emission_low = range.emission_high = to_double(m.emission);
  if (m.emission_texture != no_texture) {
    const TexelRange texels = texels_over(m.emission_texture, triangle);
    range.emission_low *= texels.low, range.emission_high *= texels.high;
  }
  return range;
}

}  // namespace lambake
