#include "lambake/measure/bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lambake/core/parallel.h"
#include "lambake/measure/surface.h"
#include "lambake/shading/moved_corners.h"

namespace lambake {

SurfaceBound surface_bound(const Scene& scene, const BakedColors& baked, const BoundOptions& options) {
  const ComparedSurface surface(scene, baked);
  const std::size_t n = surface.n_triangles();
  constexpr float infinity = std::numeric_limits<float>::infinity();
  constexpr std::size_t block_size = 256;
  std::vector<double> bounds(n);
  parallel_blocks(n, block_size, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> lights;
    BoundOptions how = options;
    for (std::size_t f = begin; f < end; ++f) {
      const Patch patch = surface.patch(f);
      if (area_of(patch) == 0) continue;
      find_reaching_lights(scene.lights, patch, lights);
      const FinishRange finish = surface.finish_range(f);
      const double moved = change_by_moved_corners(patch, finish, surface.stored_corners(f), options.space);
      how.accept = std::max(options.accept - moved, 0.5 * options.accept);
      bounds[f] = bound_with_change(bound_patch(patch, finish, scene.lights, lights, how).bound, moved,
                                    options.space);
    }
  });

  SurfaceBound result;
  result.triangle_bound.reserve(n);
  for (const double bound : bounds) {
    result.max_bound = std::max(result.max_bound, bound);
    result.triangle_bound.push_back(bound > 0 ? std::nextafter(static_cast<float>(bound), infinity) : 0.0f);
    result.unbounded_triangles += !std::isfinite(bound);
  }
  return result;
}

double certified_maximum(const Scene& scene, const BakedColors& baked, ErrorSpace space, double accept) {
  if (baked.certificate && baked.certificate->space == space) return baked.certificate->max_bound;
  return surface_bound(scene, baked, {.space = space, .accept = accept}).max_bound;
}

}  // namespace lambake
