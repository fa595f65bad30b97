#include "lambake/bake/lamp_contact.h"

#include <algorithm>
#include <tuple>

#include "lambake/core/bounds.h"
#include "lambake/core/parallel.h"
#include "lambake/shading/lambert.h"

namespace lambake {
namespace {

constexpr std::size_t block_size = 4096;

bool is_before(const glm::vec3& a, const glm::vec3& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

/// E from the lights whose share float can hold.
LinearRgb finite_irradiance(std::span<const Light> lights, const glm::vec3& position,
                            const glm::vec3& normal) {
  LinearRgb sum;
  for (const Light& light : lights) {
    const LinearRgb share = light.intensity * received<float>(light, position, normal);
    if (is_finite(sum + share)) sum += share;
  }
  return sum;
}

}  // namespace

Findings tend_lamp_contacts(std::span<const Light> lights, std::span<const glm::vec3> positions,
                            std::span<const glm::vec3> normals, std::span<const LinearRgb> base,
                            std::span<LinearRgb> colors) {
  std::vector<glm::vec3> lamps;
  LinearRgb most_of_suns;
  for (const Light& light : lights)
    if (light.type == LightType::directional)
      most_of_suns += light.intensity;
    else
      lamps.push_back(light.position);
  if (lamps.empty() && is_finite(most_of_suns)) return {};
  std::sort(lamps.begin(), lamps.end(), is_before);

  struct Counts {
    std::size_t on_lamp = 0, overflowed = 0;
  };
  std::vector<Counts> blocks((positions.size() + block_size - 1) / block_size);
  parallel_blocks(positions.size(), block_size, [&](std::size_t begin, std::size_t end) {
    Counts& counts = blocks[begin / block_size];
    for (std::size_t v = begin; v < end; ++v) {
      counts.on_lamp +=
          is_finite(positions[v]) && std::binary_search(lamps.begin(), lamps.end(), positions[v], is_before);
      if (is_finite(colors[v])) continue;
      ++counts.overflowed;
      const LinearRgb e = finite_irradiance(lights, positions[v], normals[v]);
      colors[v] = base.empty() ? e : base[v] * e;
    }
  });
  Counts total;
  for (const Counts& counts : blocks) total.on_lamp += counts.on_lamp, total.overflowed += counts.overflowed;
  Findings findings;
  add_finding(findings, "points_on_a_lamp", total.on_lamp,
              "vert[ex (or centre of a face) lies|ices (or centres of faces) lie] exactly on a lamp: no "
              "direction, [it gets|they get] nothing from it");
  add_finding(findings, "points_too_bright", total.overflowed,
              "vert[ex (or centre of a face) gets|ices (or centres of faces) get] more light than a float "
              "holds, as next to a lamp; "
              "the lights that are too much are left out there");
  return findings;
}

}  // namespace lambake
