#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "lambake/core/color.h"
#include "lambake/core/finding.h"
#include "lambake/core/progress.h"
#include "lambake/scene/scene.h"

namespace lambake {

enum class BakeMethod {
  face,    ///< One colour per face: the light at its centroid along its geometric normal.
  sample,  ///< The light at the vertex: Gouraud.
};

/// A vertex that was made on the line between two earlier ones: value = (1 − t)·value[a] + t·value[b],
/// for every attribute (normals are renormalised). 0 < t < 1.
struct EdgeCut {
  std::uint32_t a = 0, b = 0;
  float t = 0.5f;
};

/// Vertex colours and the mesh that they belong to.
struct BakedColors {
  /// The mesh that carries the colours, where that is not the scene's own: `face` gives each triangle its own
  /// three vertices (in the order of the triangles), cutting methods add vertices and triangles.
  std::optional<Mesh> mesh;
  /// V' linear colours, unclamped: vertex base colour ⊗ E(p, n). Multiplied by the material's base colour and
  /// texture, plus emission, they are P at the vertex. Unlit materials have their vertex base colour here.
  std::vector<LinearRgb> colors;
  /// Where the method cut the scene's mesh: new vertex V + i is cuts[i]. Otherwise empty.
  std::vector<EdgeCut> cuts;
  /// F' indices of the scene's triangle that each triangle of `mesh` lies in; empty: the identity.
  std::vector<std::uint32_t> parent_triangles;
  Findings findings;
};

struct BakeOptions {
  BakeMethod method = BakeMethod::sample;
  Progress progress{};
};

/// Bakes the scene's lights into vertex colours.
/// @param scene  mesh with normals (V), at least one material.
/// @throws InvalidScene if the mesh has no normals where the method needs them.
BakedColors bake(const Scene& scene, const BakeOptions& options);

/// The mesh that `baked` belongs to.
inline const Mesh& mesh_of(const Scene& scene, const BakedColors& baked) {
  return baked.mesh ? *baked.mesh : scene.mesh;
}

}  // namespace lambake
