#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "lambake/core/color.h"

namespace lambake {

/// How far a file may have a vertex from where it is made between two of consecutive triangles, as it rounds
/// in other coordinates than those of the mesh.
struct CutRounding {
  std::uint32_t triangle_end = 0;  ///< From the end of the one before to here.
  double distance = 0;
};

/// A triangle mesh as plain arrays, in world space. V vertices, F triangles.
///
/// A vertex has one value of every attribute: where the corners of a file's vertex differ (texture
/// seams, creases, faces of different colour or material), the vertex is split, the copies come after
/// the vertices of the file, and `source_vertices` maps all of them back.
struct Mesh {
  std::vector<glm::vec3> positions;  ///< V; may be non-finite where the file has them so.
  std::vector<glm::vec3> normals;    ///< V unit vectors, or none; (0,0,0) has no direction and gets no light.
  std::vector<LinearRgb> colors;     ///< V, or none: base colour per vertex; multiplies the material's.
  std::vector<float> opacities;      ///< V in [0,1], or none: alpha of the vertex colour.
  std::array<std::vector<glm::vec2>, 2> texcoords;  ///< V each, or none; origin at the image's upper left.
  std::vector<glm::uvec3> triangles;           ///< F; counter-clockwise seen from outside; every index < V.
  std::vector<std::uint32_t> materials;        ///< F indices into Scene::materials, or none: all 0.
  std::vector<std::uint32_t> source_vertices;  ///< V: the file's vertex of each, or none: the identity.
  std::vector<std::uint32_t>
      normal_groups;                        ///< V: equal numbers share one normal, or none: by source vertex.
  std::vector<std::uint32_t> source_faces;  ///< F: the file's face (polygon) of each, or none: the identity.
  std::vector<CutRounding>
      cut_roundings;  ///< Of all triangles, ascending; or none: the file has world space.

  std::size_t n_vertices() const { return positions.size(); }
  std::size_t n_triangles() const { return triangles.size(); }
  std::uint32_t material_of(std::size_t triangle) const {
    return materials.empty() ? 0 : materials[triangle];
  }
  std::uint32_t source_vertex_of(std::size_t v) const {
    return source_vertices.empty() ? static_cast<std::uint32_t>(v) : source_vertices[v];
  }
  /// V: the group of each vertex that shares one normal, or none: each its own.
  const std::vector<std::uint32_t>& shared_normals() const {
    return normal_groups.empty() ? source_vertices : normal_groups;
  }
  std::uint32_t source_face_of(std::size_t f) const {
    return source_faces.empty() ? static_cast<std::uint32_t>(f) : source_faces[f];
  }
  /// CutRounding::distance of a triangle.
  double cut_rounding_of(std::size_t triangle) const;
};

/// Appends to every per-vertex array of `mesh` a copy of vertex `v`; returns the copy's index.
/// `source_vertices` is made if there was none.
std::uint32_t append_vertex_copy(Mesh& mesh, std::uint32_t v);

/// One more than the largest of `numbers`, as of Mesh::source_vertices: arrays over them are that long.
/// @param n_default  where there are none.
std::size_t count_of_numbers(const std::vector<std::uint32_t>& numbers, std::size_t n_default);

/// V: the material of each vertex's triangles, which are of one; 0 where there is none.
std::vector<std::uint32_t> vertex_materials(const Mesh& mesh);

/// The positions of the vertices that are in a face, in their order: what is to be seen.
std::vector<glm::vec3> positions_in_faces(const Mesh& mesh);

/// For each of `n_materials` whether a triangle is of it.
std::vector<bool> used_materials(const Mesh& mesh, std::size_t n_materials);

/// @throws InvalidScene if an array has not the length that its comment gives, an index is out of range,
/// `cut_roundings` are not of all triangles in ascending order, or there are more than 2^31 vertices or a
/// third of 2^32 triangles, whose corners 32 bits could not number.
void check_mesh(const Mesh& mesh, std::size_t n_materials);

}  // namespace lambake
