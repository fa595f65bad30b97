#pragma once

#include <cstddef>

#include "lambake/scene/mesh.h"

namespace lambake {

/// What could fail in a mesh, counted on the vertices of the file (copies made by splitting count as one).
struct Defects {
  std::size_t non_finite_vertices = 0;    ///< A coordinate is NaN or infinite.
  std::size_t isolated_vertices = 0;      ///< In no triangle.
  std::size_t repeated_vertex_faces = 0;  ///< Triangles that name a vertex twice.
  std::size_t zero_area_faces = 0;        ///< Triangles of three different vertices without area.
  std::size_t duplicate_faces = 0;        ///< Triangles with the same three vertices as an earlier one.
  std::size_t border_edges = 0;           ///< Edges of one triangle.
  std::size_t non_manifold_edges = 0;     ///< Edges of more than two triangles.
  std::size_t conflicting_edges = 0;      ///< Edges that two triangles run through in the same direction.
  std::size_t duplicate_positions = 0;    ///< Vertices at exactly the (finite) position of an earlier one.
  std::size_t components = 0;             ///< Parts connected by shared vertices.
  bool is_closed = false;                 ///< No border edges and at least one triangle.
  bool is_consistently_wound = false;     ///< No conflicting edges.
};

/// O(V + F) for a bounded number of faces around a vertex; the same for any number of threads.
/// @param with_parts  counts duplicate_positions and components too, O(V log V).
Defects find_defects(const Mesh& mesh, bool with_parts = true);

}  // namespace lambake
