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

/// Up to `capacity` places. Entries from n on must be sound too; they are computed along.
struct PlaceBlock {
  static constexpr std::size_t capacity = 256;
  std::size_t n = 0;
  alignas(64) std::array<std::uint32_t, capacity> triangles{};
  alignas(64) std::array<float, capacity> weights1{}, weights2{};  ///< Barycentrics of corners 1 and 2.
  alignas(64) std::array<std::array<std::int32_t, capacity>, 3> corners{};  ///< Written by find_corners().
};

/// Looks up the vertices of the block's triangles. The mesh has at least one triangle.
void find_corners(const Mesh& mesh, PlaceBlock& block);

/// @param values  V. @param out  at least `capacity`.
void interpolate(std::span<const glm::vec3> values, const PlaceBlock& block, std::span<glm::vec3> out);
void interpolate(std::span<const LinearRgb> values, const PlaceBlock& block, std::span<LinearRgb> out);

/// The unit shading normals n/|n| of n(b); (0,0,0) where that vanishes. A normal that all three corners share
/// is taken as it is, so that a flat face is lit exactly as its vertices are.
void interpolate_normals(std::span<const glm::vec3> normals, const PlaceBlock& block,
                         std::span<glm::vec3> out);

}  // namespace lambake
