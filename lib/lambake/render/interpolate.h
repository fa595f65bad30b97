#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "lambake/core/color.h"
#include "lambake/scene/mesh.h"

/// Per-vertex values at places on triangles, many at once in vectors; internal to the folder.
///
/// v(b) = v0 + b1·(v1 − v0) + b2·(v2 − v0): equal values at the corners give exactly that value. The same
/// bits on every vector path.
namespace lambake {

/// Up to 16 groups of 16 neighbouring pixels: vectors load them as they lie in memory, and neighbours mostly
/// share a triangle, whose corners are then loaded once.
struct PlaceBlock {
  static constexpr std::size_t group = 16, max_groups = 16, capacity = group * max_groups;

  std::size_t n_groups = 0;
  std::array<std::size_t, max_groups> first_pixels;  ///< Of each group.

  // Of each place, written by load_places(). A pixel without a triangle (or past the picture's end) stands
  // for corner 0 of triangle 0.
  alignas(64) std::array<std::uint32_t, capacity> triangles;
  alignas(64) std::array<float, capacity> weights1, weights2;  ///< Barycentrics of the corners 1 and 2.
  alignas(64) std::array<std::array<std::int32_t, capacity>, 3> corners;  ///< Not where few triangles are.
  std::array<bool, max_groups> has_few_triangles, is_covered;  ///< Of each group; the latter: every pixel.
  const glm::uvec3* mesh_triangles = nullptr;

  std::size_t n_places() const { return n_groups * group; }
};

/// Fills the block for the groups that begin at its `first_pixels`. The mesh has at least one triangle.
/// @param triangles, barycentrics  of all pixels, as in Visibility.
void load_places(const Mesh& mesh, std::span<const std::uint32_t> triangles,
                 std::span<const glm::vec2> barycentrics, PlaceBlock& block);

/// @param values  V. @param out  n_places() or more.
void interpolate(std::span<const LinearRgb> values, const PlaceBlock& block, std::span<LinearRgb> out);

/// The unit shading normals n/|n| of n(b); (0,0,0) where that vanishes. A normal that all three corners share
/// is taken as it is, so that a flat face is lit exactly as its vertices are.
void interpolate_normals(std::span<const glm::vec3> normals, const PlaceBlock& block,
                         std::span<glm::vec3> out);

/// Both the positions and the unit shading normals: the triangles are looked up once.
void interpolate_points(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                        const PlaceBlock& block, std::span<glm::vec3> out_positions,
                        std::span<glm::vec3> out_normals);

}  // namespace lambake
