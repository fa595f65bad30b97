#include "lambake/shading/moved_corners.h"

#include <algorithm>

namespace lambake {

double change_by_moved_corners(const Patch& patch, const FinishRange& finish, const glm::dmat3& stored,
                               ErrorSpace space) {
  if (stored == patch.positions) return 0;
  const glm::dvec3 e1 = patch.positions[1] - patch.positions[0], e2 = patch.positions[2] - patch.positions[0];
  const glm::dvec3 normal = glm::cross(e1, e2);
  const double square = glm::dot(normal, normal);
  if (!(square > 0)) return 0;
  // The point with the barycentrics b is stored at Σ b_k stored_k, and there the patch has other
  // barycentrics. By how much the colour differs is linear in b, and so is largest at a corner.
  glm::dvec3 most(0);
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 move = stored[k] - patch.positions[k];
    const double b1 = glm::dot(glm::cross(move, e2), normal) / square,
                 b2 = glm::dot(glm::cross(e1, move), normal) / square;
    most = glm::max(
        most, glm::abs((patch.colors[1] - patch.colors[0]) * b1 + (patch.colors[2] - patch.colors[0]) * b2));
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
