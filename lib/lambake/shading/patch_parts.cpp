#include "lambake/shading/patch_parts.h"

#include <algorithm>
#include <cmath>

#include "lambake/core/quadrature.h"
#include "lambake/geometry/triangle_distance.h"

namespace lambake {
namespace {

/// Whether a part is wider than a light is away, or than what its cone has lit there.
bool is_wide(const Patch& patch, std::span<const Light> all, std::span<const std::uint32_t> lights,
             const glm::dmat3& part) {
  const glm::dmat3 p = patch.positions * part;
  const glm::dvec3 center = (p[0] + p[1] + p[2]) / 3.0;
  const double width =
      std::max({glm::length(p[1] - p[0]), glm::length(p[2] - p[1]), glm::length(p[0] - p[2])});
  return std::any_of(lights.begin(), lights.end(), [&](std::uint32_t i) {
    const Light& light = all[i];
    if (light.type == LightType::directional) return false;
    const glm::dvec3 at(light.position), to_center = center - at;
    double slope = 1;
    if (light.type == LightType::spot) {
      slope = std::tan(std::min(double(light.outer_cone_rad), 1.57));
      const glm::dvec3 axis(light.spot_direction);
      const double along = glm::dot(to_center, axis), off = glm::length(to_center - along * axis);
      if (off - width > std::max(0.0, along + width) * slope) return false;  // The cone misses it.
      slope = std::min(slope, 1.0);
    }
    if (width <= slope * (glm::length(to_center) - width)) return false;  // Far away.
    return width > slope * distance_from_origin(p[0] - at, p[1] - at, p[2] - at);
  });
}

}  // namespace

std::vector<glm::dmat3> cut_at_terminators(const Patch& patch, std::span<const Light> all,
                                           std::span<const std::uint32_t> lights, std::size_t most) {
  std::vector<glm::dmat3> parts{glm::dmat3(1.0)}, next;
  for (const std::uint32_t light : lights) {
    next.clear();
    for (const glm::dmat3& part : parts) cut_at_terminator(all[light], patch, part, next);
    if (next.size() > most) break;
    parts.swap(next);
  }
  return parts;
}

void quarter_wide_parts(const Patch& patch, std::span<const Light> all, std::span<const std::uint32_t> lights,
                        std::vector<glm::dmat3>& parts) {
  const auto is_positional = [&](std::uint32_t i) { return all[i].type != LightType::directional; };
  if (std::none_of(lights.begin(), lights.end(), is_positional)) return;
  constexpr std::size_t max_quarters = 512;
  constexpr int max_depth = 14;
  std::vector<glm::dmat3> narrow, next;
  const std::size_t most = parts.size() + max_quarters;
  for (int depth = 0; depth < max_depth && narrow.size() + parts.size() < most; ++depth) {
    next.clear();
    for (const glm::dmat3& part : parts)
      if (is_wide(patch, all, lights, part))
        for (const glm::dmat3& quarter : quarters(part)) next.push_back(quarter);
      else
        narrow.push_back(part);
    parts.swap(next);
  }
  parts.insert(parts.end(), narrow.begin(), narrow.end());
}

}  // namespace lambake
