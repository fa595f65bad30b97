#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "lambake/bake/color_output.h"
#include "lambake/core/color.h"
#include "lambake/core/finding.h"
#include "lambake/core/progress.h"
#include "lambake/geometry/edge_cut.h"
#include "lambake/scene/scene.h"
#include "lambake/shading/light_tree.h"

namespace lambake {

enum class BakeMethod {
  face,           ///< One colour per face: the light at its centroid along its geometric normal.
  sample,         ///< The light at the vertex: Gouraud.
  average,        ///< The mean of the faces around: usually worse than `sample`, kept as the warning it is.
  least_squares,  ///< The colours of least squared error over the surface (Kavan, Bargteil, Sloan 2011).
  uniform,        ///< `sample` after quartering every triangle `levels` times.
  adaptive,       ///< `sample` on the mesh cut where the error is, until it is nowhere above the tolerance.
};

/// What a method that cuts can promise of its result.
struct Certificate {
  ErrorSpace space = ErrorSpace::display;  ///< Where its errors are meant.
  bool is_certified = false;               ///< The bound is at most the tolerance on every triangle.
  double max_bound = 0;                    ///< The largest bound of a triangle; infinite if one has none.
  std::size_t open_triangles = 0;          ///< With a bound above the tolerance.
  bool is_out_of_time = false;             ///< Cutting ended by BakeOptions::max_seconds; it might go on.
  double smallest_angle_before = 0;        ///< Radians, of the triangles with area.
  double smallest_angle_after = 0;
};

/// Vertex colours and the mesh that they belong to.
struct BakedColors {
  /// The mesh that carries the colours, where that is not the scene's own: `face` gives each triangle its own
  /// three vertices (in the order of the triangles), cutting methods add vertices and triangles.
  std::optional<Mesh> mesh;
  /// V' linear colours, unclamped: vertex base colour ⊗ E(p, n). Multiplied by the material's base colour and
  /// texture, plus emission, they are P at the vertex. Unlit materials have their vertex base colour here.
  std::vector<LinearRgb> colors;
  /// By material, whether its emission does not show with them; empty: all does. For comparing what an output
  /// shows (hidden_emission()): baking leaves it empty.
  std::vector<bool> hidden_emission;
  /// Where the method cut the scene's mesh: new vertex V + i is cuts[i]. Otherwise empty.
  std::vector<EdgeCut> cuts;
  /// F' indices of the scene's triangle that each triangle of `mesh` lies in; empty: the identity.
  std::vector<std::uint32_t> parent_triangles;
  /// adaptive: what was reached.
  std::optional<Certificate> certificate;
  /// Upper bound of how far merging many lights has moved a colour; 0 where all were summed.
  LightError light_error;
  Findings findings;
};

struct BakeOptions {
  BakeMethod method = BakeMethod::sample;
  /// adaptive: the error |F − G| that no place and no channel may exceed; on screen 1 is white.
  double tolerance = 1.0 / 255;
  ErrorSpace tolerance_space = ErrorSpace::display;  ///< adaptive: where the tolerance is meant.
  /// adaptive: stops before it makes more. 0 is eight times the scene's vertices and 65,536: a scene that
  /// needs more needs light per pixel.
  std::size_t max_vertices = 0;
  double max_seconds = 0;  ///< adaptive: stops cutting after this; 0 is no limit.
  /// adaptive: what becomes of the colours in the output, so that what is certified is what is written
  /// (take_stored_colors() of what is baked).
  ColorOutput output{};
  /// How much of an encoded colour in [0,1] merging many lights may cost, certified (shading/light_tree.h);
  /// 0 sums them all.
  double light_tolerance = 0.25 / 255;
  /// least_squares: weight of the jumps of the colour's derivative across edges; >= 0, no unit.
  double gradient_weight = 0.003;
  int levels = 1;  ///< uniform: >= 0.
  Progress progress{};
};

/// Bakes the scene's lights into vertex colours.
/// @param scene  mesh with normals (V), at least one material.
/// @throws InvalidScene if the mesh has no normals where the method needs them, or would get too many
/// triangles; InvalidOption for a tolerance, weight or number of levels out of its range.
BakedColors bake(const Scene& scene, const BakeOptions& options);

/// The mesh that `baked` belongs to.
inline const Mesh& mesh_of(const Scene& scene, const BakedColors& baked) {
  return baked.mesh ? *baked.mesh : scene.mesh;
}

/// @throws InvalidScene if `baked` does not have a colour for each vertex of its mesh. @param who  of the
/// message.
void check_colors(const Scene& scene, const BakedColors& baked, const char* who);

}  // namespace lambake
