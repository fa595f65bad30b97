#include "lambake/shading/moved_corners.h"

#include <algorithm>

namespace lambake {

namespace {

/// The step in which GPUs weigh texels: eight bits (Direct3D 11 asks for as many).
constexpr double least_shift = 1.0 / 256;

/// The share of the range of a texture's values by which a look-up changes.
/// @param slopes  gradients of the barycentrics of corners 1 and 2.
double texel_change(const TexelCorners& texels, const Patch& patch, const StoredCorners& stored,
                    const std::array<glm::dvec3, 2>& slopes) {
  const glm::dvec2 t1 = texels.at[1] - texels.at[0], t2 = texels.at[2] - texels.at[0];
  glm::dvec2 shift(0);
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 move = stored.positions[k] - patch.positions[k];
    shift = glm::max(shift, glm::abs(t1 * glm::dot(move, slopes[0]) + t2 * glm::dot(move, slopes[1])));
  }
  for (int axis = 0; axis < 2; ++axis)
    shift[axis] += stored.rounding * glm::length(t1[axis] * slopes[0] + t2[axis] * slopes[1]);
  shift += texels.rounding;
  if (std::max(shift.x, shift.y) <= least_shift) return 0;
  return texels.is_nearest ? 1 : std::min(shift.x + shift.y, 1.0);
}

}  // namespace

StoredCorners stored_corners(const Mesh& mesh, std::size_t triangle, const Finishes& finishes,
                             const Mesh& uncut, std::size_t n_uncut, std::size_t parent) {
  const glm::uvec3& t = mesh.triangles[triangle];
  StoredCorners corners;
  for (int c = 0; c < 3; ++c) corners.positions[c] = mesh.positions[t[c]];
  if (std::max({t[0], t[1], t[2]}) >= n_uncut) {
    corners.rounding = uncut.cut_rounding_of(parent);
    corners.texels = finishes.texel_corners(mesh, triangle);
  }
  return corners;
}

double change_by_moved_corners(const Patch& patch, const FinishRange& finish, const StoredCorners& stored,
                               ErrorSpace space) {
  const bool has_texels = stored.texels[0].rounding + stored.texels[1].rounding != glm::dvec2(0);
  if (stored.positions == patch.positions && stored.rounding == 0 && !has_texels) return 0;
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
  const double base_change = texel_change(stored.texels[0], patch, stored, {slope1, slope2}),
               emission_change = texel_change(stored.texels[1], patch, stored, {slope1, slope2});
  double change = 0;
  for (int c = 0; c < 3; ++c) {
    const auto [darkest, brightest] =
        std::minmax({patch.colors[0][c], patch.colors[1][c], patch.colors[2][c]});
    const double linear =
        finish.base_high[c] * most[c] +
        base_change * (finish.base_high[c] - finish.base_low[c]) * std::max(brightest, 0.0) +
        emission_change * (finish.emission_high[c] - finish.emission_low[c]);
    // The encoding is concave: a change shows most where it begins at the darkest.
    const double low = std::max(0.0, finish.base_low[c] * darkest + finish.emission_low[c] - linear);
    change = std::max(
        change, space == ErrorSpace::linear ? linear : compared(low + linear, space) - compared(low, space));
  }
  return change;
}

}  // namespace lambake
