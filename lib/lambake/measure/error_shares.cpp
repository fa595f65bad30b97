#include "lambake/measure/error_shares.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "lambake/core/parallel.h"
#include "lambake/core/quadrature.h"
#include "lambake/measure/surface.h"

namespace lambake {
namespace {

/// Places that textures are sampled at over the whole surface, about.
constexpr std::size_t n_samples = 2'000'000;

/// ∫ (base ⊗ Σ b_k d_k)² dA / A over a triangle, by channel. d is linear: without a texture
/// ∫ (Σ b_k d_k)² dA = A/12 (Σ d_k² + (Σ d_k)²).
/// @param d       by corner. @param levels  how often a triangle is quartered to sample its texture.
glm::dvec3 mean_square(const ComparedSurface& surface, std::size_t f, const glm::dmat3& d, int levels) {
  if (!surface.has_texture(f)) {
    const glm::dvec3 base = surface.finish_at(f, glm::dvec3(1.0 / 3)).base, sum = d[0] + d[1] + d[2];
    return base * base * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + sum * sum) / 12.0;
  }
  std::vector<glm::dmat3> parts{glm::dmat3(1.0)};
  for (int level = 0; level < levels; ++level) {
    std::vector<glm::dmat3> finer;
    for (const glm::dmat3& part : parts)
      for (const glm::dmat3& quarter : quarters(part)) finer.push_back(quarter);
    parts = std::move(finer);
  }
  glm::dvec3 sum(0);
  for (const glm::dmat3& part : parts)
    for (const QuadratureNode& node : quadrature_4) {
      const glm::dvec3 b = part * node.b, value = surface.finish_at(f, b).base * (d * b);
      sum += node.weight * value * value;
    }
  return sum / double(parts.size());
}

/// RMS over the surface and the channels of a difference that is linear between the vertices.
double rms_of_difference(const ComparedSurface& surface, const std::vector<LinearRgb>& a,
                         const std::vector<LinearRgb>& b) {
  int levels = 0;
  for (std::size_t n = surface.n_triangles() * quadrature_4.size(); 4 * n <= n_samples && levels < 5; n *= 4)
    ++levels;
  std::vector<double> sums(surface.n_triangles()), areas(surface.n_triangles());
  parallel_blocks(surface.n_triangles(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      areas[f] = area_of(surface.patch(f));
      glm::dmat3 d;
      for (int c = 0; c < 3; ++c) {
        const std::uint32_t v = surface.mesh().triangles[f][c];
        d[c] = to_double(a[v] - b[v]);
      }
      if (areas[f] == 0 || d == glm::dmat3(0.0)) continue;
      const glm::dvec3 square = mean_square(surface, f, d, levels);
      sums[f] = areas[f] * (square[0] + square[1] + square[2]) / 3;
    }
  });
  double sum = 0, total = 0;
  for (std::size_t f = 0; f < sums.size(); ++f) sum += sums[f], total += areas[f];
  return total > 0 ? std::sqrt(sum / total) : 0;
}

}  // namespace

ErrorShares error_shares(const Scene& scene, const BakedColors& baked, const ColorOutput& output,
                         double interpolation) {
  ErrorShares shares;
  shares.interpolation = interpolation;
  if (!output.shown) return shares;
  const ComparedSurface surface(scene, baked);
  const std::vector<std::uint32_t> materials = vertex_materials(surface.mesh());
  std::vector<ColorRange> ranges;
  for (const Material& material : scene.materials) ranges.push_back(stored_range(output, material));
  std::vector<LinearRgb> clipped = baked.colors, stored;
  stored.reserve(clipped.size());
  for (std::size_t v = 0; v < clipped.size(); ++v) {
    const auto& [low, high] = ranges[materials[v]];
    LinearRgb& c = clipped[v];
    c = {std::clamp(c.r, low.r, high.r), std::clamp(c.g, low.g, high.g), std::clamp(c.b, low.b, high.b)};
    stored.push_back(as_stored(output, c, scene.materials[materials[v]]));
  }
  shares.clipping = rms_of_difference(surface, clipped, baked.colors);
  shares.quantisation = rms_of_difference(surface, stored, clipped);
  return shares;
}

}  // namespace lambake
