#include "lambake/measure/bound.h"

#include <algorithm>
#include <cmath>

#include "lambake/core/parallel.h"
#include "lambake/measure/surface.h"
#include "lambake/shading/moved_corners.h"

namespace lambake {

SurfaceBound surface_bound(const Scene& scene, const BakedColors& baked, const BoundOptions& options) {
  const ComparedSurface surface(scene, baked);
  const std::size_t n = surface.n_triangles();
  constexpr float infinity = std::numeric_limits<float>::infinity();
  constexpr std::size_t block_size = 256;
  std::vector<PatchBound> bounds(n);
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
      bounds[f] = bound_patch(patch, finish, scene.lights, lights, how);
      bounds[f].bound = bound_with_change(bounds[f].bound, moved, options.space);
    }
  });

  SurfaceBound result;
  result.triangle_bound.resize(n);
  result.triangle_found.resize(n);
  std::size_t worst = 0;
  for (std::size_t f = 0; f < n; ++f) {
    const PatchBound& b = bounds[f];
    result.triangle_bound[f] = b.bound > 0 ? std::nextafter(static_cast<float>(b.bound), infinity) : 0.0f;
    result.triangle_found[f] = b.found > 0 ? std::nextafter(static_cast<float>(b.found), 0.0f) : 0.0f;
    result.unbounded_triangles += !std::isfinite(b.bound);
    result.max_found = std::max(result.max_found, b.found);
    if (b.bound > bounds[worst].bound) worst = f;
  }
  if (n == 0) return result;
  result.max_bound = bounds[worst].bound;
  result.worst.triangle = static_cast<std::uint32_t>(worst);
  result.worst.source_face = surface.mesh().source_face_of(worst);
  result.worst.barycentrics = bounds[worst].found_at;
  result.worst.position = surface.patch(worst).positions * bounds[worst].found_at;
  result.worst.error = bounds[worst].found;
  return result;
}

double certified_maximum(const Scene& scene, const BakedColors& baked, ErrorSpace space, double accept) {
  if (baked.certificate && baked.certificate->space == space) return baked.certificate->max_bound;
  return surface_bound(scene, baked, {.space = space, .accept = accept}).max_bound;
}

}  // namespace lambake
