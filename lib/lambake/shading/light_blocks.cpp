#include "lambake/shading/light_blocks.h"

#include <algorithm>
#include <glm/glm.hpp>

#include "lambake/shading/lambert.h"

namespace lambake {
namespace {

LightKind kind_of(const Light& light) {
  if (light.type == LightType::directional) return {};
  return {light.type, light.range > 0, double(light.decay)};
}

void put(LightBlock& block, std::size_t i, const Light& light) {
  const glm::vec3& at = light.type == LightType::directional ? light.direction_to_light : light.position;
  block.x[i] = at.x, block.y[i] = at.y, block.z[i] = at.z;
  block.range[i] = light.range;
  if (light.type != LightType::spot) return;
  const glm::dvec3 axis(light.spot_direction);
  block.axis_x[i] = axis.x, block.axis_y[i] = axis.y, block.axis_z[i] = axis.z;
  const double outer = versine(double(light.outer_cone_rad));
  // The axis is of length 1 up to the rounding of its floats.
  block.cos_outer[i] = (1 + glm::dot(axis, axis)) / 2 - outer;
  block.cone_scale[i] = 1 / std::max(0.001, outer - versine(double(light.inner_cone_rad)));
}

void add(std::vector<LightBlock>& blocks, const LightKind& kind, std::uint32_t index, const Light& light) {
  if (blocks.empty() || blocks.back().kind != kind || blocks.back().n == LightBlock::size)
    blocks.emplace_back().kind = kind;
  LightBlock& block = blocks.back();
  const std::size_t i = block.n++;
  put(block, i, light);
  const double intensity[] = {light.intensity.r, light.intensity.g, light.intensity.b};
  for (int c = 0; c < 3; ++c) block.intensity[c][i] = intensity[c];
  block.brightest[i] = *std::max_element(intensity, intensity + 3);
  block.lights[i] = index;
}

}  // namespace

std::vector<LightBlock> light_blocks(std::span<const Light> all, std::span<const std::uint32_t> lights) {
  const auto is_before = [&](std::uint32_t a, std::uint32_t b) { return kind_of(all[a]) < kind_of(all[b]); };
  std::vector<std::uint32_t> by_kind;
  if (!std::is_sorted(lights.begin(), lights.end(), is_before)) {
    by_kind.assign(lights.begin(), lights.end());
    std::stable_sort(by_kind.begin(), by_kind.end(), is_before);
    lights = by_kind;
  }
  std::vector<LightBlock> blocks;
  for (const std::uint32_t i : lights) add(blocks, kind_of(all[i]), i, all[i]);
  for (LightBlock& block : blocks)
    for (std::size_t k = block.n; k < LightBlock::size; ++k) put(block, k, all[block.lights[block.n - 1]]);
  return blocks;
}

}  // namespace lambake
