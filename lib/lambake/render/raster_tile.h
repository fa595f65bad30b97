#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "lambake/render/screen.h"
#include "lambake/render/visibility.h"

/// Triangles into the pixels of one tile; internal to the folder.
namespace lambake {

/// The pixels of a tile while triangles are drawn into it.
struct Tile {
  static constexpr std::size_t n_pixels = std::size_t{tile_side} * tile_side;
  static constexpr std::size_t padding = 16;  ///< Vectors may reach past the last pixel.

  std::int32_t x = 0, y = 0;  ///< Of its first pixel.
  int width = tile_side, height = tile_side;
  std::vector<float> nearness;           ///< tile_side² and padding, rows of tile_side.
  std::vector<std::uint32_t> triangles;  ///< The same.

  Tile() : nearness(n_pixels + padding), triangles(n_pixels + padding) {}
  void clear();
};

/// Triangles on the screen: the mesh's, or pieces of clipped ones.
struct ScreenTriangles {
  static constexpr std::uint32_t is_piece = 0x80000000u;  ///< Of an entry: the rest is a piece's index.

  std::span<const ScreenVertex> vertices;  ///< V.
  std::span<const glm::uvec3> triangles;   ///< F.
  std::span<const ScreenTriangle> pieces;
  std::span<const std::uint32_t> piece_triangles;  ///< The triangle of each piece.

  std::uint32_t triangle_of(std::uint32_t entry) const {
    return (entry & is_piece) != 0 ? piece_triangles[entry & ~is_piece] : entry;
  }
};

/// Draws the entries in their order, in either orientation: where a pixel's centre is inside, by the top-left
/// rule, and nothing is as near already. Ascending triangles: ties are won by the lowest.
void raster_triangles(const ScreenTriangles& screen, std::span<const std::uint32_t> entries, Tile& tile);

/// Asked for a pixel (of the picture) that a triangle would win: whether it is drawn there.
using PixelTest = std::function<bool(std::uint32_t triangle, std::uint32_t x, std::uint32_t y)>;

/// The same for one entry with a test per pixel.
void raster_tested_triangle(const ScreenTriangles& screen, std::uint32_t entry, const PixelTest& is_drawn,
                            Tile& tile);

}  // namespace lambake
