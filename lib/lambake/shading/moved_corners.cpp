#include "lambake/shading/moved_corners.h"

#include <algorithm>

namespace lambake {

double change_by_moved_corners(const Patch& patch, const FinishRange& finish, const StoredCorners& stored,
                               ErrorSpace space) {
  if (stored.positions == patch.positions && stored.rounding == 0) return 0;
  const glm::dvec3 e1 = patch.positions[1] - patch.positions[0], e2 = patch.positions[2] - patch.positions[0];
  const glm::dvec3 normal = glm::cross(e1, e2);
  const double square = glm::dot(normal, normal);
  if (!(square > 0)) return 0;
  // The point with the barycentrics b is stored at Σ b_k stored_k, and there the patch has other
  // barycentrics. By how much the colour differs is linear in b, and so is largest at a corner.
  const glm::dvec3 slope1 = glm::cross(e2, normal) / square, slope2 = glm::cross(normal, e1) / square;
  const glm::dvec3 rise1 = patch.colors[1] - patch.colors[0], rise2 = patch.colors[2] - patch.colors[0];
  glm::dvec3 most(0);
  for (int c = 0; c < 3; ++c) {
    const glm::dvec3 gradient = rise1[c] * slope1 + rise2[c] * slope2;
    for (int k = 0; k < 3; ++k)
      most[c] = std::max(most[c], std::abs(glm::dot(stored.positions[k] - patch.positions[k], gradient)));
    most[c] += stored.rounding * glm::length(gradient);
  }
  double change = 0;
  for (int c = 0; c < 3; ++c) {
    const double linear = finish.base_high[c] * most[c];
    // The encoding is concave: a change shows most where it begins at the darkest.
    const double darkest = std::min({patch.colors[0][c], patch.colors[1][c], patch.colors[2][c]});
    const double low = std::max(0.0, finish.base_low[c] * darkest + finish.emission_low[c] - linear);
    change = std::max(
        change, space == ErrorSpace::linear ? linear : compared(low + linear, space) - compared(low, space));
  }
  return change;
}

}  // namespace lambake
