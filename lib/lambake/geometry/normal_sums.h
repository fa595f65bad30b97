#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "lambake/geometry/normals.h"

/// The inner loops of vertex_normals(): what faces add at their corners, on Highway's vectors.
namespace lambake {

/// Sum over the faces around a vertex. Not initialised.
struct alignas(32) NormalSum {
  double values[4];  ///< x, y, z of unit normals times their weights; last the weights.
};

/// Twice the area vector of a triangle, in double: exact to a few ulp for float positions. (0,0,0) where
/// there is no area: shorter than 1e-12 of the longest edge squared, or not finite.
glm::dvec3 area_vector(const glm::vec3& p0, const glm::vec3& p1, const glm::vec3& p2);

/// True if every triangle surely has an area by area_vector(); false says nothing.
bool have_area(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles);

/// The least and the greatest number that the corners of triangles name.
struct IndexRange {
  std::uint32_t first = 0, last = 0;
};

/// The sums of consecutive groups; what faces add to other groups is left to other windows.
struct NormalWindow {
  std::span<const std::uint32_t> group_of;  ///< Of each vertex, or none: itself.
  std::uint32_t first = 0;                  ///< The group of the first sum.
  std::span<NormalSum> sums;
  float unit = 1;  ///< Of lengths in the weights: a power of two near the size of the mesh.
};

/// Adds the faces to the sums of their corners' groups, in the order of the faces: the same bits on every
/// vector path, and whatever the window. A share is right to float's accuracy, some 1e-7 of itself, for
/// slivers too.
/// @param triangles  at least one. @returns the range of the groups that they name, also outside of the
/// window.
IndexRange add_faces(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                     NormalWeight weight, const NormalWindow& window);

/// The same in double, for the groups alone that are wanted. @param is_wanted  by sum.
void add_faces_exactly(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                       NormalWeight weight, const NormalWindow& window, std::span<const char> is_wanted);

/// The directions of the sums; (0,0,0) where there is none: the faces cancel, or there are none. Sets the
/// sums to 0.
/// @param uncertain  gets the numbers of sums that are short, as their faces look apart: the shares of
/// add_faces() are not exact enough for them.
/// @returns false if some of the sums have no direction.
bool unit_normals(std::span<NormalSum> sums, std::span<glm::vec3> normals,
                  std::vector<std::uint32_t>& uncertain);

}  // namespace lambake
