#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "lambake/render/screen.h"

/// Triangles into the pixels of one tile; internal to the folder.
namespace lambake {

inline constexpr int tile_side = 64;

/// The pixels of a tile while triangles are drawn into it.
struct Tile {
  std::int32_t x = 0, y = 0;  ///< Of its first pixel.
  int width = tile_side, height = tile_side;
  std::vector<float> nearness;           ///< tile_side², rows of tile_side.
  std::vector<std::uint32_t> triangles;  ///< tile_side².

  Tile() : nearness(tile_side * tile_side), triangles(tile_side * tile_side) {}
  void clear();
};

/// Asked for a pixel (of the picture) that a triangle would win: whether it is drawn there.
using PixelTest = std::function<bool(std::uint32_t triangle, std::uint32_t x, std::uint32_t y)>;

/// Draws a triangle, in either orientation: where a pixel's centre is inside, by the top-left rule, and
/// nothing is as near already. Triangles come in the order of their index, so ties are won by the lowest.
/// @param is_drawn  empty: every pixel.
void raster_triangle(const ScreenVertex& v0, const ScreenVertex& v1, const ScreenVertex& v2,
                     std::uint32_t triangle, const PixelTest& is_drawn, Tile& tile);

}  // namespace lambake
