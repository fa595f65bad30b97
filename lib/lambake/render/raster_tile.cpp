#include "lambake/render/raster_tile.h"

#include <algorithm>
#include <limits>

#include "lambake/render/raster_setup.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lambake/render/raster_tile.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>  // compiles the part below once per vector path
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, Tile::padding>;
using Ints = hn::Rebind<std::int32_t, Floats>;

/// One edge in the columns of a vector; moves on row by row.
struct EdgeColumns {
  hn::Vec<Ints> e, step_y;

  EdgeColumns(const EdgeSetup& edge, hn::Vec<Ints> column) {
    const Ints i32;
    e = hn::Add(hn::Set(i32, edge.e), hn::Mul(hn::Set(i32, edge.step_x), column));
    step_y = hn::Set(i32, edge.step_y);
  }
  HWY_INLINE void next_row() { e = hn::Add(e, step_y); }
};

/// Draws the columns of a box from `begin` on that one vector holds.
HWY_INLINE void raster_columns(const RasterSetup& setup, int begin, std::uint32_t triangle, float* nearest,
                               std::uint32_t* triangles) {
  const Floats f;
  const Ints i32;
  const auto column = hn::Iota(i32, begin);
  // Negative, hence outside, in the columns past the box.
  const auto past_box = hn::VecFromMask(i32, hn::Gt(column, hn::Set(i32, setup.width - 1)));
  EdgeColumns edge0(setup.edges[0], column), edge1(setup.edges[1], column), edge2(setup.edges[2], column);
  const auto along_row = hn::Mul(hn::Set(f, setup.nearness_x), hn::ConvertTo(f, column));
  const auto least = hn::Set(f, setup.least), most = hn::Set(f, setup.most);
  const auto index = hn::BitCast(i32, hn::Set(hn::Rebind<std::uint32_t, Floats>(), triangle));
  for (int row = 0; row < setup.height; ++row) {
    const auto outside = hn::Or(hn::Or(edge0.e, edge1.e), hn::Or(edge2.e, past_box));
    const auto is_inside = hn::Gt(outside, hn::Set(i32, -1));
    edge0.next_row(), edge1.next_row(), edge2.next_row();
    if (!hn::AllFalse(i32, is_inside)) {
      const float row_nearness = setup.nearness + setup.nearness_y * static_cast<float>(row);
      const auto nearness = hn::Min(hn::Max(hn::Add(hn::Set(f, row_nearness), along_row), least), most);
      const auto before = hn::LoadU(f, nearest);
      const auto wins = hn::And(hn::RebindMask(f, is_inside), hn::Gt(nearness, before));
      // Whole vectors: masked stores are ten times slower on some processors.
      hn::StoreU(hn::IfThenElse(wins, nearness, before), f, nearest);
      auto* const at = reinterpret_cast<std::int32_t*>(triangles);
      hn::StoreU(hn::IfThenElse(hn::RebindMask(i32, wins), index, hn::LoadU(i32, at)), i32, at);
    }
    nearest += tile_side;
    triangles += tile_side;
  }
}

/// Few pixels, one by one: a vector's store would hold up the next triangle's load beside it.
HWY_INLINE void raster_few_pixels(const RasterSetup& setup, std::uint32_t triangle, float* nearest,
                                  std::uint32_t* triangles) {
  for (int j = 0; j < setup.height; ++j, nearest += tile_side, triangles += tile_side)
    for (int i = 0; i < setup.width; ++i) {
      if (!is_inside(setup, i, j)) continue;
      const float nearness = nearness_at(setup, i, j);
      if (!(nearness > nearest[i])) continue;
      nearest[i] = nearness;
      triangles[i] = triangle;
    }
}

/// Memory that a later entry will read: a tile meets the mesh in short pieces, which caches do not foresee.
constexpr std::size_t ahead = 8;

HWY_INLINE void prefetch_triangle(const ScreenTriangles& screen, std::uint32_t entry) {
  if ((entry & ScreenTriangles::is_piece) == 0) hwy::Prefetch(&screen.triangles[entry]);
}
HWY_INLINE void prefetch_vertices(const ScreenTriangles& screen, std::uint32_t entry) {
  if ((entry & ScreenTriangles::is_piece) != 0) return;
  for (int c = 0; c < 3; ++c) hwy::Prefetch(&screen.vertices[screen.triangles[entry][c]]);
}

void raster_entries(const ScreenTriangles& screen, std::span<const std::uint32_t> entries, Tile& tile) {
  const int lanes = static_cast<int>(hn::Lanes(Floats()));
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const std::uint32_t entry = entries[i];
    if (i + 2 * ahead < entries.size()) prefetch_triangle(screen, entries[i + 2 * ahead]);
    if (i + ahead < entries.size()) prefetch_vertices(screen, entries[i + ahead]);
    const RasterSetup setup = raster_setup(screen, entry, tile);
    if (setup.width == 0) continue;
    const std::uint32_t triangle = screen.triangle_of(entry);
    float* const nearest = tile.nearness.data() + first_index(setup, tile);
    std::uint32_t* const triangles = tile.triangles.data() + first_index(setup, tile);
    if (setup.width * setup.height <= few_pixels) {
      raster_few_pixels(setup, triangle, nearest, triangles);
      continue;
    }
    for (int begin = 0; begin < setup.width; begin += lanes)
      raster_columns(setup, begin, triangle, nearest + begin, triangles + begin);
  }
}

}  // namespace
}  // namespace lambake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lambake {

namespace {
HWY_EXPORT(raster_entries);
}  // namespace

void Tile::clear() {
  std::fill(nearness.begin(), nearness.end(), -std::numeric_limits<float>::infinity());
  std::fill(triangles.begin(), triangles.end(), no_triangle);
}

void raster_triangles(const ScreenTriangles& screen, std::span<const std::uint32_t> entries, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(raster_entries)(screen, entries, tile);
}

void raster_tested_triangle(const ScreenTriangles& screen, std::uint32_t entry, const PixelTest& is_drawn,
                            Tile& tile) {
  const RasterSetup setup = raster_setup(screen, entry, tile);
  const std::uint32_t triangle = screen.triangle_of(entry);
  for (int j = 0; j < setup.height; ++j)
    for (int i = 0; i < setup.width; ++i) {
      const std::size_t at = first_index(setup, tile) + static_cast<std::size_t>(j * tile_side + i);
      if (!is_inside(setup, i, j)) continue;
      const float nearness = nearness_at(setup, i, j);
      if (!(nearness > tile.nearness[at])) continue;
      if (!is_drawn(triangle, static_cast<std::uint32_t>(setup.x + i),
                    static_cast<std::uint32_t>(setup.y + j)))
        continue;
      tile.nearness[at] = nearness;
      tile.triangles[at] = triangle;
    }
}

}  // namespace lambake
#endif  // HWY_ONCE
