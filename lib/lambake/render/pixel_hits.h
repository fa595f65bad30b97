#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "lambake/render/view_transform.h"
#include "lambake/scene/mesh.h"

/// Where the rays of pixels meet the triangles that are seen there; internal to the folder.
namespace lambake {

/// Where a pixel's ray meets the plane of a triangle.
struct RayHit {
  glm::dvec2 barycentrics{0};  ///< Of the corners 1 and 2, brought into the triangle.
  double depth = 0;            ///< Distance along the view axis.
};

/// Möller and Trumbore (1997), in double. The pixel's centre may lie outside of the true triangle by the
/// rounding to the subpixel grid, so the weights are brought into it; a triangle seen exactly edge-on has
/// none, and its centroid is taken.
RayHit hit_triangle(const PixelRay& ray, const glm::vec3& p0, const glm::vec3& p1, const glm::vec3& p2);

/// The same for n pixels of row y from x on, in vectors and to the last bit.
/// @param triangles     n, or no_triangle: weights 0, depth infinity. n is a multiple of 16, and one more
///                      may be read.
/// @param barycentrics  n, written. @param depths  n, written.
void hit_row(const Mesh& mesh, const ViewTransform& view, std::uint32_t x, std::uint32_t y,
             const std::uint32_t* triangles, std::size_t n, glm::vec2* barycentrics, float* depths);

}  // namespace lambake
