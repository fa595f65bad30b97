#include "lambake/bake/cut_bounds.h"

#include <algorithm>
#include <cmath>

#include "lambake/core/parallel.h"
#include "lambake/shading/moved_corners.h"

namespace lambake {
namespace {

constexpr std::size_t block_size = 64;

/// Enclosures computed for a triangle at most: a cut is the better way to go on.
constexpr int max_parts = 400;

/// Where the base colour spans texels, bounds come no nearer to the truth than by about this factor.
constexpr double tightness_of_texels = 1.15;

}  // namespace

CutBounds::CutBounds(const Scene& scene, const BakeOptions& options, const CutMesh& cut,
                     const CutColors& colors, const Finishes& finishes, const Deadline& deadline)
    : scene_(scene),
      options_(options),
      cut_(cut),
      colors_(colors),
      finishes_(finishes),
      deadline_(deadline),
      values_(cut.mesh().n_triangles(), infinity) {}

std::vector<std::uint32_t> CutBounds::above(double level) const {
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t f = 0; f < values_.size(); ++f)
    if (values_[f] > level) triangles.push_back(f);
  return triangles;
}

void CutBounds::update(std::span<const std::uint32_t> triangles, double level) {
  const BoundOptions how{.space = options_.tolerance_space,
                         .accept = level,
                         .reject = level,
                         .tightness = 1,
                         .max_parts = max_parts};
  parallel_blocks(triangles.size(), block_size, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> lights;
    for (std::size_t i = begin; i < end; ++i)
      values_[triangles[i]] = deadline_.is_past() ? infinity : bound_of(triangles[i], how, lights);
  });
}

void CutBounds::update_closely(std::span<const std::uint32_t> triangles) {
  const BoundOptions how{.space = options_.tolerance_space};
  parallel_blocks(triangles.size(), block_size, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> lights;
    for (std::size_t i = begin; i < end && !deadline_.is_past(); ++i) {
      double& known = values_[triangles[i]];
      if (std::isfinite(known)) known = std::min(known, bound_of(triangles[i], how, lights));
    }
  });
}

/// @param how  with levels for what is seen, rounding included. @param lights  room to work in.
double CutBounds::bound_of(std::uint32_t triangle, BoundOptions how,
                           std::vector<std::uint32_t>& lights) const {
  const Patch patch = colors_.patch(cut_.mesh().triangles[triangle]);
  if (area_of(patch) == 0) return 0;
  find_reaching_lights(scene_.lights, patch, lights);
  const FinishRange finish = finishes_.over(cut_.mesh(), triangle);
  if (finish.base_low != finish.base_high) how.tightness = std::max(how.tightness, tightness_of_texels);
  const double moved = change_by_rounding(triangle, patch, finish);
  for (double* level : {&how.accept, &how.reject}) *level = std::max(*level - moved, 0.5 * *level);
  const double known = bound_patch(patch, finish, scene_.lights, lights, how).bound;
  return bound_with_change(known, moved, options_.tolerance_space);
}

/// What the colours of a triangle change because its corners are stored as float.
double CutBounds::change_by_rounding(std::uint32_t triangle, const Patch& patch,
                                     const FinishRange& finish) const {
  const StoredCorners corners = stored_corners(cut_.mesh(), triangle, finishes_, scene_.mesh,
                                               cut_.n_uncut_vertices(), cut_.parent_triangles()[triangle]);
  return change_by_moved_corners(patch, finish, corners, options_.tolerance_space);
}

bool CutBounds::is_rounded_too_far(std::uint32_t triangle, double level) const {
  return change_by_rounding(triangle, colors_.patch(cut_.mesh().triangles[triangle]),
                            finishes_.over(cut_.mesh(), triangle)) > 0.5 * level;
}

}  // namespace lambake
