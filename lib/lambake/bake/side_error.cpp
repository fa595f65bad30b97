#include "lambake/bake/side_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lambake {

SideError side_error(const Patch& patch, const FinishRange& finish, std::span<const Light> all,
                     std::span<const std::uint32_t> lights, ErrorSpace space) {
  const auto error_at = [&](double t) {
    const glm::dvec3 b(1 - t, t, 0);
    const glm::dvec3 f = reference_at(patch, all, lights, finish.is_unlit, b), g = patch.colors * b;
    return compared(finish.emission_low + finish.base_high * f, space) -
           compared(finish.emission_low + finish.base_high * g, space);
  };
  const auto largest = [](const glm::dvec3& e) {
    return std::max({std::abs(e[0]), std::abs(e[1]), std::abs(e[2])});
  };
  const glm::dvec3 at_start = error_at(0), at_end = error_at(1);
  SideError side;
  side.error = std::max(largest(at_start), largest(at_end));
  const auto look = [&](double t) {
    const glm::dvec3 error = error_at(t);
    side.error = std::max(side.error, largest(error));
    const double bulge = largest(error - (1 - t) * at_start - t * at_end);
    if (!(bulge > side.bulge)) return false;
    side.bulge = bulge, side.t = t;
    return true;
  };

  // Denser near the ends: on screen the peak lies close to a dark one.
  std::vector<double> samples{0,     1 / 256.0, 1 / 64.0, 1 / 16.0,  0.125,     0.25,        0.375, 0.5,
                              0.625, 0.75,      0.875,    15 / 16.0, 63 / 64.0, 255 / 256.0, 1};
  for (const std::uint32_t i : lights) {
    const double s0 = facing(all[i], patch.positions[0], patch.normals[0]);
    const double s1 = facing(all[i], patch.positions[1], patch.normals[1]);
    if (s0 * s1 < 0) samples.push_back(terminator_on_edge(all[i], patch, 0, 1));
  }
  std::sort(samples.begin(), samples.end());
  std::size_t nearest = 1;
  for (std::size_t i = 1; i + 1 < samples.size(); ++i)
    if (look(samples[i])) nearest = i;
  double low = samples[nearest - 1], high = samples[nearest + 1];
  for (int i = 0; i < 6 && side.bulge > 0; ++i) {
    const double best = side.t;
    for (const double t : {0.5 * (low + best), 0.5 * (best + high)}) {
      if (look(t)) {
        (t > best ? low : high) = best;
        break;
      }
      (t < best ? low : high) = t;
    }
  }
  return side;
}

}  // namespace lambake
