#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

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

/// @param triangles  at least one. @param group_of  number of each vertex, or none: itself.
IndexRange index_range(std::span<const glm::uvec3> triangles, std::span<const std::uint32_t> group_of);

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
/// @param named  range of the groups that the triangles name: faces are picked only where it leaves the
/// window.
void add_faces(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
               NormalWeight weight, const NormalWindow& window, IndexRange named);

/// The same in double, for the groups alone that are wanted. @param is_wanted  by sum.
void add_faces_exactly(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                       NormalWeight weight, const NormalWindow& window, std::span<const char> is_wanted);

/// True for a sum that is short, as its faces look apart: the shares of add_faces() are not exact enough for
/// it.
bool is_uncertain(const NormalSum& sum);

struct UnitNormalCounts {
  std::size_t n_without = 0;    ///< Sums that have no direction.
  std::size_t n_uncertain = 0;  ///< By is_uncertain().
};

/// The directions of the sums; (0,0,0) where there is none: the faces cancel, or there are none.
UnitNormalCounts unit_normals(std::span<const NormalSum> sums, std::span<glm::vec3> normals);

}  // namespace lambake
