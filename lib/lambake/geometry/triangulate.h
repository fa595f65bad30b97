#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace lambake {

/// Appends the triangles of a polygon, concave ones too, each wound as the polygon is.
///
/// The polygon is taken as it lies in the coordinate plane most across its normal (Newell's). A convex
/// quadrilateral is cut along its shorter diagonal, other polygons by clipping ears. Corners that repeat the
/// one before (and a last that repeats the first) are left out; of a polygon with fewer than three different
/// neighbours the first three corners are kept as they are. O(n) for convex polygons, O(n · reflex) for
/// others, limited to some thousand steps a corner.
/// @param positions  of the vertices.
/// @param polygon    three or more indices < positions.size().
/// @returns false if the polygon crosses itself, has no area, is not finite or too intricate: then some of
/// the triangles may overlap or lie outside.
bool triangulate_polygon(std::span<const glm::vec3> positions, std::span<const std::uint32_t> polygon,
                         std::vector<glm::uvec3>& triangles);

/// Two quadrilaterals that share three vertices, as around a vertex inside that no other face has, must not
/// be cut along the same diagonal: the same triangle would be there twice, back to back. Where they are, one
/// of them is cut along its other diagonal, unless that would turn a triangle over. O(V + F).
/// @param faces  F: the polygon of each triangle, those of one side by side.
void part_folded_quads(std::span<const glm::vec3> positions, std::span<const std::uint32_t> faces,
                       std::span<glm::uvec3> triangles);

}  // namespace lambake
