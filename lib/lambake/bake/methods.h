#pragma once

#include <vector>

#include "lambake/bake/bake.h"

/// The methods behind bake(), one function each; internal to the folder.
namespace lambake {

/// V' colours: vertex base colour ⊗ E at the vertices of `mesh` (normals V'), which shares the scene's
/// materials.
std::vector<LinearRgb> sample_at_vertices(const Scene& scene, const Mesh& mesh);

BakedColors bake_face(const Scene& scene);

BakedColors bake_adaptive(const Scene& scene, const BakeOptions& options);

}  // namespace lambake
