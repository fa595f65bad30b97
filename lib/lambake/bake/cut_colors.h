#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "lambake/bake/bake.h"
#include "lambake/geometry/cutting.h"
#include "lambake/shading/patch.h"

namespace lambake {

/// The colours of a mesh that is being cut; internal to the folder. Each vertex has the reference there,
/// moved by what balancing has asked for, as the output stores it.
///
/// Where the output spoils a colour (clips what the screen would not clip as well, or rounds away more than
/// the tolerance has room for), no cut around the vertex can mend that, so cuts are chosen for the colour as
/// it should be.
class CutColors {
 public:
  /// The arguments must outlive it. V' is always that of `cut`.
  CutColors(const Scene& scene, const BakeOptions& options, const CutMesh& cut);

  /// Gives the vertices that `cut` has made since the last call their colours.
  void add_new_vertices();

  /// The triangle of the vertices `t`, with the colours that it has now.
  Patch patch(const glm::uvec3& t) const;
  /// The reference at the vertex.
  const LinearRgb& exact(std::size_t v) const { return exact_[v]; }

  /// Asks for the colour of `v` to be `shift` off the reference. Of all that was asked of a vertex, the
  /// largest rise and the largest fall of a channel count, added.
  void ask(std::size_t v, const glm::vec3& shift);
  /// Does what was asked; copies of a vertex with one reference move together, so that no seam shows.
  /// @returns V': whether the colour has changed.
  std::vector<char> move_asked();
  /// Takes back what was asked of all vertices at the places (CutMesh::places()) that are marked.
  /// @returns V': whether the colour has changed.
  std::vector<char> move_back(const std::vector<char>& is_marked_place);

  /// What rounding in the output takes of the tolerance, as compared; 0 where it takes more than half, so
  /// that colours are spoilt by it.
  double rounding() const { return rounding_; }

  bool is_spoilt(std::size_t v) const { return !is_spoilt_.empty() && is_spoilt_[v]; }
  /// Puts the colours as the output stores them everywhere, spoilt ones too.
  void take_stored();
  /// The colours as computed, of which the output makes those of take_stored(): another one may hold more.
  std::vector<LinearRgb> take_colors();

 private:
  LinearRgb moved(std::size_t v) const;
  void move(std::size_t v);
  std::vector<char> move_all();
  void share_among_copies();
  const Material& material(std::size_t v) const { return scene_.materials[materials_[v]]; }
  /// What rounding in the output takes of colours of a material that it does not clip.
  double largest_rounding(const Material& material) const;
  double loss(const Material& material, const LinearRgb& color, const LinearRgb& stored) const;
  bool spoils(const Material& material, const LinearRgb& color, const LinearRgb& stored) const;

  const Scene& scene_;
  const BakeOptions& options_;
  const CutMesh& cut_;
  double rounding_ = 0;
  std::vector<std::uint32_t> all_lights_;
  std::vector<std::uint32_t> materials_;  ///< V': that of its triangles, which are of one material.
  std::vector<LinearRgb> exact_;          ///< V'
  std::vector<LinearRgb> colors_;         ///< V'
  std::vector<glm::vec3> rises_, falls_;  ///< V'; >= 0 and <= 0.
  std::vector<LinearRgb> stored_;         ///< V', if the output stores colours otherwise.
  std::vector<char> is_spoilt_;           ///< V', with `stored_`.
};

}  // namespace lambake
