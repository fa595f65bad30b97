#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "lambake/scene/mesh.h"

namespace lambake {

/// How the normals of the faces around a vertex are weighted.
enum class NormalWeight {
  angle,    ///< By the angle of the corner: independent of how faces are cut (Thürmer & Wüthrich 1998).
  area,     ///< By the area of the face.
  uniform,  ///< All the same (Gouraud 1971).
  max,      ///< By sin / (product of the edge lengths): exact on spheres (Max 1999).
};

struct VertexNormals {
  std::vector<glm::vec3> normals;  ///< V unit vectors, in the space of the positions.
  std::size_t undefined = 0;       ///< Vertices of a face that have no direction; stored as (0,0,0).
};

/// Vertex normals: weighted mean of the incident face normals.
///
/// Vertices of one Mesh::normal_groups (by default the copies of one file vertex) get one normal together, so
/// that a texture seam is not a crease. O(V + F); the same bits for any number of threads. Zero-area faces,
/// faces that repeat a vertex and faces with a non-finite vertex add nothing.
/// @param mesh    V positions, F triangles; isolated vertices are allowed and have no direction.
/// @param weight  The weighting. No default: results differ by up to 19 degrees.
VertexNormals vertex_normals(const Mesh& mesh, NormalWeight weight);

/// F unit normals of the triangles; (0,0,0) where a triangle has no area or is not finite.
std::vector<glm::vec3> face_normals(const Mesh& mesh);

}  // namespace lambake
