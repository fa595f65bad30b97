#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lambake/render/view_transform.h"

/// From the world to vertices on the subpixel grid; internal to the folder.
namespace lambake {

/// Positions on the screen are snapped to 1/256 pixel: from there coverage is integer arithmetic, so
/// triangles that share an edge cover each pixel exactly once.
inline constexpr int subpixel_bits = 8;
inline constexpr std::int32_t subpixels = 1 << subpixel_bits;

/// How far beyond the picture triangles may reach before they are clipped. With this and max_picture_side
/// edge functions fit 64 bits, and 32 bits within a tile (raster_setup.h).
inline constexpr double guard_band_pixels = 8192;

/// A vertex on the screen.
struct ScreenVertex {
  std::int32_t x = 0, y = 0;  ///< In subpixels.
  float nearness = 0;  ///< Greater is nearer, linear on the screen: 1/depth, or −depth (orthographic).
  std::int32_t outcode = 0;  ///< Bits of `Outcode`.
};

enum Outcode : std::int32_t {
  left_of_picture = 1,
  right_of_picture = 2,
  above_picture = 4,
  below_picture = 8,
  too_near = 16,
  too_far = 32,
  beyond_guard_band = 64,
  not_finite = 128,
};
/// A triangle with one of these at all three vertices is not seen.
inline constexpr std::int32_t unseen_if_common =
    left_of_picture | right_of_picture | above_picture | below_picture | too_near | too_far;
/// A triangle with one of these at any vertex must be clipped; the vertex has no place on the screen.
inline constexpr std::int32_t clipped_if_any = too_near | too_far | beyond_guard_band;

struct ScreenTriangle {
  ScreenVertex v[3];
};

/// A camera and the picture that it makes.
struct Screen {
  ViewTransform view;
  double near, far;      ///< `far` is infinity where the camera has none.
  double width, height;  ///< In pixels.

  Screen(const Camera& camera, std::uint32_t picture_width, std::uint32_t picture_height);
};

/// @param out  as many as `world`.
void project_vertices(const Screen& screen, std::span<const glm::vec3> world, std::span<ScreenVertex> out);

/// Clips a triangle at the near and far planes and the guard band, and appends the pieces, which keep its
/// orientation. Points on an edge come out the same from both of the triangles that share it, and vertices as
/// project_vertices() has them.
void clip_triangle(const Screen& screen, const glm::vec3 (&world)[3], std::vector<ScreenTriangle>& pieces);

}  // namespace lambake
