#pragma once

#include <cstddef>
#include <vector>

#include "lambake/bake/bake.h"
#include "lambake/scene/scene.h"
#include "lambake/shading/patch_bound.h"

namespace lambake {

/// Upper bounds of |G − F|, never below the truth (docs/bound.md).
struct SurfaceBound {
  double max_bound = 0;                 ///< Of all triangles and channels; infinite if one has no bound.
  std::vector<float> triangle_bound;    ///< F', rounded up; infinite where a light lies on the surface.
  std::size_t unbounded_triangles = 0;  ///< With an infinite bound.
};

/// Bounds the error of every triangle that has an area. Colours are taken as `baked` has them: store them as
/// the output does to have its quantisation and clipping included. Linear in
/// triangles × lights; deterministic for any number of threads.
/// @throws InvalidScene if `baked` does not fit the scene, or the scene has no normals.
SurfaceBound surface_bound(const Scene& scene, const BakedColors& baked, const BoundOptions& options);

/// An upper bound of the largest error of the surface: what the method certifies, where it does so in this
/// space, otherwise that of surface_bound().
/// @param accept  A bound this small need not be improved: an error that is known to be there.
/// Errors as of surface_bound().
double certified_maximum(const Scene& scene, const BakedColors& baked, ErrorSpace space, double accept = 0);

}  // namespace lambake
