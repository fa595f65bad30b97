#include "lambake/bake/balance.h"

#include <algorithm>
#include <cmath>

namespace lambake {

glm::dmat3 balancing_shifts(const Patch& patch, const glm::dmat3& exact, const FinishRange& finish,
                            std::span<const Light> all, std::span<const std::uint32_t> lights,
                            const glm::dvec3& b, double allowed, ErrorSpace space) {
  glm::dmat3 shifts(0.0);
  const glm::dvec3 f = reference_at(patch, all, lights, finish.is_unlit, b), g = patch.colors * b;
  const glm::dvec3 exact_there = exact * b;
  for (int c = 0; c < 3; ++c) {
    const double base = finish.base_high[c], emission = finish.emission_low[c];
    if (!(base > 0)) continue;
    const double error = compared(emission + base * g[c], space) - compared(emission + base * f[c], space);
    if (!(std::abs(error) > allowed)) continue;
    // The colour whose appearance is `by` away from that of `color`.
    const auto away = [&](double color, double by) {
      return (compared_inverse(compared(emission + base * color, space) + by, space) - emission) / base;
    };
    const double by = error < 0 ? allowed : -allowed;
    glm::dvec3 room;
    for (int k = 0; k < 3; ++k) {
      const double r = away(exact[k][c], by) - exact[k][c];
      room[k] = by > 0 ? std::max(r, 0.0) : std::min(r, 0.0);
    }
    const double share = (away(f[c], -by) - exact_there[c]) / glm::dot(room, b);
    if (!(share > 0 && share <= 1)) continue;
    for (int k = 0; k < 3; ++k) shifts[k][c] = share * room[k];
  }
  return shifts;
}

}  // namespace lambake
