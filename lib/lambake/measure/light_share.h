#pragma once

#include <vector>

#include "lambake/scene/scene.h"

namespace lambake {

/// What one light does to the surface, as shares of what all of them do.
struct LightShare {
  double light = 0;  ///< Of the light that the surface receives: E by area, all channels.
  double error = 0;  ///< Of the error that interpolating E over each triangle makes: |E − Σ b_i E_i| by area.
};

/// One per light; each member sums to 1, or is 0 throughout where there is nothing to share.
///
/// An estimate for people: four points a triangle (edge middles and centroid), and only every k-th triangle,
/// such that triangles × lights stays below 4 million. Deterministic for any number of threads.
/// A mesh without normals has nothing to share.
std::vector<LightShare> light_shares(const Scene& scene);

}  // namespace lambake
