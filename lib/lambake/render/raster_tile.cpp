#include "lambake/render/raster_tile.h"

#include <algorithm>
#include <limits>

#include "lambake/render/visibility.h"

namespace lambake {
namespace {

/// One edge function, E(p) = (b − a) × (p − a), at the pixel centres of a box, divided by the subpixels of a
/// pixel and rounded down: a step of one pixel changes E by a multiple of that, so the sign stays exact.
/// Where the edge crosses the box, |e| is at most (|step_x| + |step_y|)·tile_side, steps being less than 2²³
/// subpixels (max_picture_side + 2·guard_band_pixels): 32 bits hold it. Elsewhere the sign is all that
/// counts.
struct Edge {
  std::int32_t e = 0;                   ///< At the first pixel of the box; >= 0 is inside.
  std::int32_t step_x = 0, step_y = 0;  ///< From pixel to pixel.
  bool is_outside = false;              ///< Nowhere inside in the box.
};

Edge edge_over_box(const ScreenVertex& a, const ScreenVertex& b, std::int32_t x, std::int32_t y, int width,
                   int height) {
  const std::int64_t dx = std::int64_t(b.x) - a.x, dy = std::int64_t(b.y) - a.y;
  const std::int64_t px = std::int64_t(x) * subpixels + subpixels / 2;
  const std::int64_t py = std::int64_t(y) * subpixels + subpixels / 2;
  // Inside is E > 0, and on the edge itself (E = 0) if it is a top or a left one.
  const bool is_top_left = dy < 0 || (dy == 0 && dx > 0);
  const std::int64_t e = (dx * (py - a.y) - dy * (px - a.x) - (is_top_left ? 0 : 1)) >> subpixel_bits;
  const std::int64_t over_x = -dy * (width - 1), over_y = dx * (height - 1);
  const std::int64_t lowest = e + std::min<std::int64_t>(over_x, 0) + std::min<std::int64_t>(over_y, 0);
  const std::int64_t highest = e + std::max<std::int64_t>(over_x, 0) + std::max<std::int64_t>(over_y, 0);
  Edge edge;
  edge.is_outside = highest < 0;
  if (lowest >= 0 || edge.is_outside) return edge;  // the same everywhere: e = 0 and no steps
  edge.e = static_cast<std::int32_t>(e);
  edge.step_x = static_cast<std::int32_t>(-dy);
  edge.step_y = static_cast<std::int32_t>(dx);
  return edge;
}

}  // namespace

void Tile::clear() {
  std::fill(nearness.begin(), nearness.end(), -std::numeric_limits<float>::infinity());
  std::fill(triangles.begin(), triangles.end(), no_triangle);
}

void raster_triangle(const ScreenVertex& v0, const ScreenVertex& v1, const ScreenVertex& v2,
                     std::uint32_t triangle, const PixelTest& is_drawn, Tile& tile) {
  const std::int64_t dx1 = std::int64_t(v1.x) - v0.x, dy1 = std::int64_t(v1.y) - v0.y;
  const std::int64_t dx2 = std::int64_t(v2.x) - v0.x, dy2 = std::int64_t(v2.y) - v0.y;
  const std::int64_t twice_area = dx1 * dy2 - dy1 * dx2;
  if (twice_area == 0) return;

  // The pixels of the tile whose centres lie in the triangle's box.
  const auto first_pixel = [](std::int32_t least) { return (least + subpixels / 2 - 1) >> subpixel_bits; };
  const auto last_pixel = [](std::int32_t most) { return (most - subpixels / 2) >> subpixel_bits; };
  const std::int32_t x_begin = std::max(first_pixel(std::min({v0.x, v1.x, v2.x})), tile.x);
  const std::int32_t y_begin = std::max(first_pixel(std::min({v0.y, v1.y, v2.y})), tile.y);
  const std::int32_t x_last = std::min(last_pixel(std::max({v0.x, v1.x, v2.x})), tile.x + tile.width - 1);
  const std::int32_t y_last = std::min(last_pixel(std::max({v0.y, v1.y, v2.y})), tile.y + tile.height - 1);
  const int width = x_last - x_begin + 1, height = y_last - y_begin + 1;
  if (width <= 0 || height <= 0) return;

  const bool is_clockwise = twice_area > 0;  // as seen on the screen
  const ScreenVertex& second = is_clockwise ? v1 : v2;
  const ScreenVertex& third = is_clockwise ? v2 : v1;
  const Edge edges[3] = {edge_over_box(v0, second, x_begin, y_begin, width, height),
                         edge_over_box(second, third, x_begin, y_begin, width, height),
                         edge_over_box(third, v0, x_begin, y_begin, width, height)};
  if (edges[0].is_outside || edges[1].is_outside || edges[2].is_outside) return;

  // Nearness is a plane over the screen; clamped to the triangle's own range, which a thin triangle seen
  // edge-on would leave by far at pixel centres, steep as it is.
  const double per_area = double(subpixels) / static_cast<double>(twice_area);
  const double n1 = double(v1.nearness) - double(v0.nearness), n2 = double(v2.nearness) - double(v0.nearness);
  const double slope_x = (n1 * static_cast<double>(dy2) - n2 * static_cast<double>(dy1)) * per_area;
  const double slope_y = (n2 * static_cast<double>(dx1) - n1 * static_cast<double>(dx2)) * per_area;
  const double from_v0_x = x_begin + 0.5 - double(v0.x) / subpixels;
  const double from_v0_y = y_begin + 0.5 - double(v0.y) / subpixels;
  const float nearness_begin =
      static_cast<float>(double(v0.nearness) + slope_x * from_v0_x + slope_y * from_v0_y);
  const float nearness_x = static_cast<float>(slope_x), nearness_y = static_cast<float>(slope_y);
  const float least = std::min({v0.nearness, v1.nearness, v2.nearness});
  const float most = std::max({v0.nearness, v1.nearness, v2.nearness});

  for (int j = 0; j < height; ++j) {
    const std::int32_t e0 = edges[0].e + edges[0].step_y * j, e1 = edges[1].e + edges[1].step_y * j,
                       e2 = edges[2].e + edges[2].step_y * j;
    const float nearness_row = nearness_begin + nearness_y * static_cast<float>(j);
    const std::size_t row = static_cast<std::size_t>(y_begin - tile.y + j) * tile_side +
                            static_cast<std::size_t>(x_begin - tile.x);
    float* const nearest = tile.nearness.data() + row;
    std::uint32_t* const triangles = tile.triangles.data() + row;
    for (int i = 0; i < width; ++i) {
      if (((e0 + edges[0].step_x * i) | (e1 + edges[1].step_x * i) | (e2 + edges[2].step_x * i)) < 0)
        continue;
      const float nearness = std::clamp(nearness_row + nearness_x * static_cast<float>(i), least, most);
      if (!(nearness > nearest[i])) continue;
      if (is_drawn && !is_drawn(triangle, static_cast<std::uint32_t>(x_begin + i),
                                static_cast<std::uint32_t>(y_begin + j)))
        continue;
      nearest[i] = nearness;
      triangles[i] = triangle;
    }
  }
}

}  // namespace lambake
