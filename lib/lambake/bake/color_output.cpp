#include "lambake/bake/color_output.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lambake/bake/bake.h"
#include "lambake/core/parallel.h"
#include "lambake/shading/patch.h"

namespace lambake {
namespace {

constexpr std::size_t block_size = 4096;

}  // namespace

LinearRgb as_stored(const ColorOutput& output, const LinearRgb& color, const Material& material) {
  if (!output.shown) return color;
  const glm::dvec3 reflected = output.shown(color, material) - to_double(emission_of(material));
  const auto channel = [](double light, float base, float was) {
    return base > 0 ? static_cast<float>(light / base) : was;
  };
  const LinearRgb& base = material.base_color;
  return {channel(reflected.r, base.r, color.r), channel(reflected.g, base.g, color.g),
          channel(reflected.b, base.b, color.b)};
}

ColorRange stored_range(const ColorOutput& output, const Material& material) {
  constexpr float far = 1e30f;
  return {as_stored(output, {-far, -far, -far}, material), as_stored(output, {far, far, far}, material)};
}

std::vector<bool> hidden_emission(const Scene& scene, const ColorOutput& output) {
  std::vector<bool> hidden;
  if (!output.hides_emission) return hidden;
  for (const Material& material : scene.materials) hidden.push_back(output.hides_emission(material));
  return hidden;
}

void take_stored_colors(const Scene& scene, const ColorOutput& output, BakedColors& baked) {
  if (!output.shown) return;
  const std::vector<std::uint32_t> materials = vertex_materials(mesh_of(scene, baked));
  parallel_blocks(baked.colors.size(), block_size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      baked.colors[v] = as_stored(output, baked.colors[v], scene.materials[materials[v]]);
  });
}

std::vector<double> errors_without_light(const Scene& scene, const ColorOutput& output, ErrorSpace space) {
  std::vector<double> errors(scene.materials.size(), 0.0);
  if (!output.shown) return errors;
  const std::vector<bool> is_used = used_materials(scene.mesh, errors.size());
  for (std::size_t m = 0; m < errors.size(); ++m) {
    if (!is_used[m]) continue;
    const Material& material = scene.materials[m];
    const glm::dvec3 base = to_double(material.base_color), emission = to_double(emission_of(material));
    const glm::dvec3 shown = output.shown({0, 0, 0}, material);
    for (int k = 0; k < 3; ++k)
      if (!(base[k] > 0))
        errors[m] = std::max(errors[m], std::abs(compared(shown[k], space) - compared(emission[k], space)));
  }
  return errors;
}

double bound_in_output(const Scene& scene, const ColorOutput& output, ErrorSpace space, double bound) {
  if (!output.gaps.empty()) return std::numeric_limits<double>::infinity();
  for (const double error : errors_without_light(scene, output, space)) bound = std::max(bound, error);
  return bound;
}

}  // namespace lambake
