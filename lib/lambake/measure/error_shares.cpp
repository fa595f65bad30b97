#include "lambake/measure/error_shares.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lambake/measure/surface.h"

namespace lambake {
namespace {

/// RMS over the surface and the channels of what is linear between the vertices: on a triangle
/// ∫ (Σ b_i d_i)² dA = A/12 (Σ d_i² + (Σ d_i)²). Base colours without textures.
double rms_of_difference(const ComparedSurface& surface, const std::vector<LinearRgb>& a,
                         const std::vector<LinearRgb>& b) {
  double sum = 0, total = 0;
  for (std::size_t f = 0; f < surface.n_triangles(); ++f) {
    const double area = area_of(surface.patch(f));
    if (area == 0) continue;
    total += area;
    const LinearRgb& base = surface.scene().materials[surface.mesh().material_of(f)].base_color;
    glm::dvec3 squares(0), plain(0);
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t v = surface.mesh().triangles[f][c];
      const LinearRgb step = base * (a[v] - b[v]);
      const glm::dvec3 d(step.r, step.g, step.b);
      squares += d * d, plain += d;
    }
    const glm::dvec3 integral = area / 12 * (squares + plain * plain);
    sum += (integral[0] + integral[1] + integral[2]) / 3;
  }
  return total > 0 ? std::sqrt(sum / total) : 0;
}

}  // namespace

ErrorShares error_shares(const Scene& scene, const BakedColors& baked, const ColorOutput& output,
                         double interpolation) {
  ErrorShares shares;
  shares.interpolation = interpolation;
  shares.clipping = shares.quantisation = 0;
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
  if (baked.certificate && stored == baked.colors) shares.clipping = shares.quantisation = std::nullopt;
  return shares;
}

}  // namespace lambake
