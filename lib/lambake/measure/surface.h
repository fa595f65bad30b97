#pragma once

#include <cstdint>
#include <vector>

#include "lambake/bake/bake.h"
#include "lambake/shading/patch.h"
#include "lambake/shading/patch_bound.h"

namespace lambake {

/// The colours between which a texture lies.
struct TexelRange {
  glm::dvec3 low{1.0}, high{1.0};
};

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
  /// Twice the area vector of the triangle, of the positions as interpolated.
  static glm::dvec3 area_vector(const Patch& patch);
  /// Base colour, emission and textures at `b`.
  Finish finish_at(std::size_t triangle, const glm::dvec3& b) const;
  /// All values that finish_at() has on the triangle lie between these.
  FinishRange finish_range(std::size_t triangle) const;
  /// Whether finish_at() is the same all over the triangle.
  bool has_texture(std::size_t triangle) const;
  const Material& material(std::size_t triangle) const {
    return scene_.materials[mesh_.material_of(triangle)];
  }
  const Mesh& mesh() const { return mesh_; }
  const Scene& scene() const { return scene_; }

 private:
  glm::dvec3 texel_at(std::uint32_t texture, std::size_t triangle, const glm::dvec3& b) const;
  TexelRange texels_over(std::uint32_t texture, std::size_t triangle) const;

  const Scene& scene_;
  const Mesh& mesh_;
  const std::vector<LinearRgb>& colors_;
  std::vector<TexelRange> texture_ranges_;                             ///< Of each whole texture.
  std::size_t n_uncut_;                                                ///< Vertices before the cuts.
  std::vector<glm::dvec3> cut_positions_, cut_normals_, cut_albedos_;  ///< Of the vertices that cuts made.
};

}  // namespace lambake
