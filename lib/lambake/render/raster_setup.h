#pragma once

#include <hwy/base.h>  // HWY_INLINE
#include <algorithm>
#include <cstdint>

#include "lambake/render/raster_tile.h"
#include "lambake/render/screen.h"

/// What drawing a triangle into a box of pixels starts from; internal to the folder.
namespace lambake {

/// One edge function, E(p) = (b − a) × (p − a), at the pixel centres of a box, divided by the subpixels of a
/// pixel and rounded down: a step of one pixel changes E by a multiple of that, so the sign stays exact.
/// Where the edge crosses the box, |e| is at most (|step_x| + |step_y|)·tile_side, steps being less than 2²³
/// subpixels (max_picture_side + 2·guard_band_pixels): 32 bits hold it. Elsewhere the sign is all that
/// counts.
struct EdgeSetup {
  std::int32_t e = 0;                   ///< At the first pixel of the box; >= 0 is inside.
  std::int32_t step_x = 0, step_y = 0;  ///< From pixel to pixel.
  bool is_outside = false;              ///< Nowhere inside in the box.
};

/// E / subpixels at the centre of pixel (x, y), the top-left rule in it: >= 0 is inside.
HWY_INLINE std::int64_t edge_at(const ScreenVertex& a, const ScreenVertex& b, std::int32_t x,
                                std::int32_t y) {
  const std::int64_t dx = std::int64_t(b.x) - a.x, dy = std::int64_t(b.y) - a.y;
  const std::int64_t px = std::int64_t(x) * subpixels + subpixels / 2;
  const std::int64_t py = std::int64_t(y) * subpixels + subpixels / 2;
  // Inside is E > 0, and on the edge itself (E = 0) if it is a top or a left one.
  const bool is_top_left = dy < 0 || (dy == 0 && dx > 0);
  return (dx * (py - a.y) - dy * (px - a.x) - (is_top_left ? 0 : 1)) >> subpixel_bits;
}

HWY_INLINE EdgeSetup edge_over_box(const ScreenVertex& a, const ScreenVertex& b, std::int32_t x,
                                   std::int32_t y, int width, int height) {
  const std::int64_t e = edge_at(a, b, x, y);
  const std::int64_t step_x = std::int64_t(a.y) - b.y, step_y = std::int64_t(b.x) - a.x;
  const std::int64_t over_x = step_x * (width - 1), over_y = step_y * (height - 1);
  const std::int64_t lowest = e + std::min<std::int64_t>(over_x, 0) + std::min<std::int64_t>(over_y, 0);
  const std::int64_t highest = e + std::max<std::int64_t>(over_x, 0) + std::max<std::int64_t>(over_y, 0);
  if (highest < 0) return {.is_outside = true};
  if (lowest >= 0) return {};  // inside everywhere: e = 0 and no steps
  return {static_cast<std::int32_t>(e), static_cast<std::int32_t>(step_x), static_cast<std::int32_t>(step_y)};
}

/// The same for a triangle of at most `few_pixels`, where 32 bits always do.
HWY_INLINE EdgeSetup edge_over_few_pixels(const ScreenVertex& a, const ScreenVertex& b, std::int32_t x,
                                          std::int32_t y) {
  return {static_cast<std::int32_t>(edge_at(a, b, x, y)), a.y - b.y, b.x - a.x};
}

/// Pixels in a row or column whose centres lie between two places on the subpixel grid.
inline std::int32_t first_pixel(std::int32_t least) {
  return (least + subpixels / 2 - 1) >> subpixel_bits;
}
inline std::int32_t last_pixel(std::int32_t most) {
  return (most - subpixels / 2) >> subpixel_bits;
}

/// Boxes of at most this many pixels are drawn one by one.
inline constexpr int few_pixels = 12;

struct RasterSetup {
  std::int32_t x = 0, y = 0;  ///< First pixel of the box.
  int width = 0, height = 0;  ///< 0: nothing to draw.
  EdgeSetup edges[3];
  /// Nearness is a plane over the screen; clamped to the triangle's own range, which a thin triangle seen
  /// edge-on would leave by far at pixel centres, steep as it is.
  float nearness = 0, nearness_x = 0, nearness_y = 0, least = 0, most = 0;
};

/// Whether everything that is drawn already in a box of the tile is as near as `most`.
HWY_INLINE bool is_hidden(float most, const Tile& tile, std::int32_t x, std::int32_t y, int width,
                          int height) {
  for (int j = 0; j < height; ++j) {
    const float* const row = tile.nearness.data() + (y - tile.y + j) * tile_side + (x - tile.x);
    for (int i = 0; i < width; ++i)
      if (most > row[i]) return false;
  }
  return true;
}

/// The box is what of the triangle's own lies in the tile.
HWY_INLINE RasterSetup raster_setup(const ScreenVertex& v0, const ScreenVertex& v1, const ScreenVertex& v2,
                                    const Tile& tile) {
  RasterSetup setup;
  setup.x = std::max(first_pixel(std::min({v0.x, v1.x, v2.x})), tile.x);
  setup.y = std::max(first_pixel(std::min({v0.y, v1.y, v2.y})), tile.y);
  const int width = std::min(last_pixel(std::max({v0.x, v1.x, v2.x})), tile.x + tile.width - 1) - setup.x + 1;
  const int height =
      std::min(last_pixel(std::max({v0.y, v1.y, v2.y})), tile.y + tile.height - 1) - setup.y + 1;
  if (width <= 0 || height <= 0) return setup;
  const bool has_few_pixels = width * height <= few_pixels;
  setup.least = std::min({v0.nearness, v1.nearness, v2.nearness});
  setup.most = std::max({v0.nearness, v1.nearness, v2.nearness});
  if (has_few_pixels && is_hidden(setup.most, tile, setup.x, setup.y, width, height)) return setup;

  const std::int64_t dx1 = std::int64_t(v1.x) - v0.x, dy1 = std::int64_t(v1.y) - v0.y;
  const std::int64_t dx2 = std::int64_t(v2.x) - v0.x, dy2 = std::int64_t(v2.y) - v0.y;
  const std::int64_t twice_area = dx1 * dy2 - dy1 * dx2;
  if (twice_area == 0) return setup;
  const bool is_clockwise = twice_area > 0;  // as seen on the screen
  const ScreenVertex& second = is_clockwise ? v1 : v2;
  const ScreenVertex& third = is_clockwise ? v2 : v1;
  const std::int32_t extent = std::max(std::max({v0.x, v1.x, v2.x}) - std::min({v0.x, v1.x, v2.x}),
                                       std::max({v0.y, v1.y, v2.y}) - std::min({v0.y, v1.y, v2.y}));
  if (has_few_pixels && extent <= (few_pixels + 1) * subpixels) {
    setup.edges[0] = edge_over_few_pixels(v0, second, setup.x, setup.y);
    setup.edges[1] = edge_over_few_pixels(second, third, setup.x, setup.y);
    setup.edges[2] = edge_over_few_pixels(third, v0, setup.x, setup.y);
  } else {
    setup.edges[0] = edge_over_box(v0, second, setup.x, setup.y, width, height);
    setup.edges[1] = edge_over_box(second, third, setup.x, setup.y, width, height);
    setup.edges[2] = edge_over_box(third, v0, setup.x, setup.y, width, height);
    if (setup.edges[0].is_outside || setup.edges[1].is_outside || setup.edges[2].is_outside) return setup;
  }
  setup.width = width;
  setup.height = height;

  const double per_area = double(subpixels) / static_cast<double>(twice_area);
  const double n1 = double(v1.nearness) - double(v0.nearness), n2 = double(v2.nearness) - double(v0.nearness);
  const double slope_x = (n1 * static_cast<double>(dy2) - n2 * static_cast<double>(dy1)) * per_area;
  const double slope_y = (n2 * static_cast<double>(dx1) - n1 * static_cast<double>(dx2)) * per_area;
  const double from_v0_x = setup.x + 0.5 - double(v0.x) / subpixels;
  const double from_v0_y = setup.y + 0.5 - double(v0.y) / subpixels;
  setup.nearness = static_cast<float>(double(v0.nearness) + slope_x * from_v0_x + slope_y * from_v0_y);
  setup.nearness_x = static_cast<float>(slope_x);
  setup.nearness_y = static_cast<float>(slope_y);
  return setup;
}

HWY_INLINE RasterSetup raster_setup(const ScreenTriangles& screen, std::uint32_t entry, const Tile& tile) {
  if ((entry & ScreenTriangles::is_piece) != 0) {
    const auto& v = screen.pieces[entry & ~ScreenTriangles::is_piece].v;
    return raster_setup(v[0], v[1], v[2], tile);
  }
  // From the lowest vertex on: repeated faces get the same nearness to the bit, whatever their order, so that
  // ties are ties.
  const glm::uvec3& t = screen.triangles[entry];
  const int first = t[0] < t[1] ? (t[0] < t[2] ? 0 : 2) : (t[1] < t[2] ? 1 : 2);
  const int second = first == 2 ? 0 : first + 1, third = first == 0 ? 2 : first - 1;
  return raster_setup(screen.vertices[t[first]], screen.vertices[t[second]], screen.vertices[t[third]], tile);
}

/// Where the box begins in the tile's arrays.
inline std::size_t first_index(const RasterSetup& setup, const Tile& tile) {
  return static_cast<std::size_t>(setup.y - tile.y) * tile_side + static_cast<std::size_t>(setup.x - tile.x);
}

/// Whether the pixel (i, j) of the box is covered, and how near the triangle is there.
inline bool is_inside(const RasterSetup& setup, int i, int j) {
  const auto at = [&](const EdgeSetup& edge) { return edge.e + edge.step_x * i + edge.step_y * j; };
  return (at(setup.edges[0]) | at(setup.edges[1]) | at(setup.edges[2])) >= 0;
}
inline float nearness_at(const RasterSetup& setup, int i, int j) {
  const float row = setup.nearness + setup.nearness_y * static_cast<float>(j);
  return std::clamp(row + setup.nearness_x * static_cast<float>(i), setup.least, setup.most);
}

}  // namespace lambake
