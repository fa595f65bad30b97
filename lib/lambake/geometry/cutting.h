#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "lambake/geometry/edge_cut.h"
#include "lambake/scene/mesh.h"

namespace lambake {

/// An edge to be cut, named by the places of its ends: low < high; the new place is at low + t (high − low).
struct CutMark {
  std::uint32_t low = 0, high = 0;
  float t = 0.5f;
};

/// A mesh whose edges are cut, so that its surface stays the same and no T-junction appears: all edges
/// between two *places* (vertices at exactly one position: copies at seams, creases and borders) are cut
/// together at one point, and each triangle around them is divided to match.
///
/// Vertices keep their index; the new ones come after them. Beside the float attributes of the mesh there are
/// the values as linear interpolation of the original ones gives them, in double; normals among those are not
/// renormalised.
class CutMesh {
 public:
  explicit CutMesh(const Mesh& mesh);

  const Mesh& mesh() const { return mesh_; }
  std::size_t n_uncut_vertices() const { return n_uncut_; }
  std::size_t n_places() const { return n_places_; }
  const std::vector<EdgeCut>& cuts() const { return cuts_; }
  const std::vector<std::uint32_t>& parent_triangles() const { return parents_; }  ///< F'
  const std::vector<std::uint32_t>& places() const { return places_; }             ///< V': the place of each.

  const std::vector<glm::dvec3>& positions() const { return positions_; }  ///< V', in double.
  const std::vector<glm::dvec3>& normals() const { return normals_; }      ///< V', not renormalised.
  const std::vector<glm::dvec3>& albedos() const { return albedos_; }      ///< V', or none as in the mesh.

  /// Makes the vertices of the marked edges (each named once). Must be followed by split().
  void make_vertices(std::span<const CutMark> marks);
  /// Divides the triangles around the vertices just made. Two cuts leave a quadrilateral a, b, c, d (in its
  /// winding); `cuts_ac` says whether it is divided along a–c rather than b–d.
  /// @returns the triangles that are new or changed, ascending.
  std::vector<std::uint32_t> split(
      const std::function<bool(std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t)>& cuts_ac);

  Mesh take_mesh() { return std::move(mesh_); }
  std::vector<EdgeCut> take_cuts() { return std::move(cuts_); }
  std::vector<std::uint32_t> take_parent_triangles() { return std::move(parents_); }

 private:
  struct Side {
    std::uint32_t mark, low, high;  ///< Its mark; its vertices at the low and high place.
    std::uint32_t corner;           ///< 3·triangle + k: from corner k to (k + 1) % 3.
  };
  std::uint32_t make_vertex(std::uint32_t low, std::uint32_t high, float t, std::uint32_t place);

  Mesh mesh_;
  std::size_t n_uncut_;
  std::uint32_t n_places_ = 0, next_source_ = 0, next_group_ = 0;
  std::vector<EdgeCut> cuts_;
  std::vector<std::uint32_t> parents_, places_;
  std::vector<glm::dvec3> positions_, normals_, albedos_;
  std::array<std::vector<glm::dvec2>, 2> texcoords_;
  std::vector<Side> sides_;             ///< To be split, by triangle.
  std::vector<std::uint32_t> middles_;  ///< The new vertex of each of `sides_`.
};

}  // namespace lambake
