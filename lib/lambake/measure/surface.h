#pragma once

#include <cstddef>
#include <vector>

#include "lambake/bake/bake.h"
#include "lambake/shading/finish.h"
#include "lambake/shading/moved_corners.h"
#include "lambake/shading/patch.h"

namespace lambake {

/// The surface as both sides of a comparison see it: the mesh that carries the colours, with the position,
/// normal and base colour of each of its vertices as the *scene's* triangle has them there. Where the mesh
/// was cut, those are interpolated along the cuts in double and not renormalised; the references to `scene`
/// and `baked` must outlive it.
class ComparedSurface {
 public:
  /// @throws InvalidScene if the arrays of `baked` do not fit together or a mesh has no normals.
  ComparedSurface(const Scene& scene, const BakedColors& baked);

  std::size_t n_triangles() const { return mesh_.n_triangles(); }
  Patch patch(std::size_t triangle) const;
  /// The corners of a triangle as the mesh has them: those that cuts made are rounded to float.
  StoredCorners stored_corners(std::size_t triangle) const;
  Finish finish_at(std::size_t triangle, const glm::dvec3& b) const {
    return finishes_.at(mesh_, triangle, b);
  }
  FinishRange finish_range(std::size_t triangle) const { return finishes_.over(mesh_, triangle); }
  bool has_texture(std::size_t triangle) const { return finishes_.has_texture(mesh_, triangle); }
  /// Whether the emission of the triangle's material does not show with the baked colours.
  bool hides_emission(std::size_t triangle) const {
    return !hidden_emission_.empty() && hidden_emission_[mesh_.material_of(triangle)];
  }
  const Mesh& mesh() const { return mesh_; }
  const Scene& scene() const { return scene_; }

 private:
  const Scene& scene_;
  const Mesh& mesh_;
  const std::vector<LinearRgb>& colors_;
  const std::vector<bool>& hidden_emission_;
  const std::vector<std::uint32_t>& parents_;
  Finishes finishes_;
  std::size_t n_uncut_;                                                ///< Vertices before the cuts.
  std::vector<glm::dvec3> cut_positions_, cut_normals_, cut_albedos_;  ///< Of the vertices that cuts made.
};

}  // namespace lambake
