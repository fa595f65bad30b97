#pragma once

#include <vector>

#include "lambake/bake/bake.h"

/// The methods behind bake(), one function each; internal to the folder.
namespace lambake {

struct SampledColors {
  std::vector<LinearRgb> colors;  ///< V'.
  LightError light_error;
};

/// V' colours: vertex base colour ⊗ E at the vertices of `mesh` (normals V'), which shares the scene's
/// materials. @param light_tolerance  BakeOptions::light_tolerance.
SampledColors sample_at_vertices(const Scene& scene, const Mesh& mesh, double light_tolerance);

BakedColors bake_face(const Scene& scene, double light_tolerance);

BakedColors bake_average(const Scene& scene);

BakedColors bake_least_squares(const Scene& scene, const BakeOptions& options);

BakedColors bake_uniform(const Scene& scene, const BakeOptions& options);

BakedColors bake_adaptive(const Scene& scene, const BakeOptions& options);

}  // namespace lambake
