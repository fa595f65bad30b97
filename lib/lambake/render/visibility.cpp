#include "lambake/render/visibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <numeric>

#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/render/cull.h"
#include "lambake/render/pixel_hits.h"
#include "lambake/render/raster_setup.h"
#include "lambake/render/raster_tile.h"
#include "lambake/render/screen.h"
#include "lambake/shading/texture.h"

namespace lambake {
namespace {

constexpr std::size_t vertex_block = 8192;
constexpr std::size_t triangle_block = 16384;
constexpr std::size_t max_count = std::size_t{1} << 29;  // 4·index fits 31 bits

/// The triangles of one block that may touch each tile.
struct Bins {
  std::vector<std::uint32_t> begin;    ///< Tiles + 1 offsets into `entries`.
  std::vector<std::uint32_t> entries;  ///< Triangles (or pieces of clipped ones), ascending in each tile.
  std::vector<ScreenTriangle> pieces;
  std::vector<std::uint32_t> piece_triangles;  ///< The triangle of each piece.
};

/// Tiles of the picture, in reading order.
struct TileGrid {
  std::uint32_t width, height, columns, rows;

  TileGrid(std::uint32_t w, std::uint32_t h)
      : width(w),
        height(h),
        columns((w + tile_side - 1) / tile_side),
        rows((h + tile_side - 1) / tile_side) {}
  std::size_t n_tiles() const { return std::size_t{columns} * rows; }
};

/// The tiles that a triangle's box touches, ends included; none where it holds no pixel's centre.
struct TileRange {
  std::int32_t column_begin = 0, row_begin = 0, column_last = -1, row_last = -1;
};

/// Calls `use` with the index of each of the tiles.
template <typename Use>
void for_each_tile(const TileRange& tiles, const TileGrid& grid, const Use& use) {
  for (std::int32_t row = tiles.row_begin; row <= tiles.row_last; ++row)
    for (std::int32_t column = tiles.column_begin; column <= tiles.column_last; ++column)
      use(static_cast<std::size_t>(row) * grid.columns + static_cast<std::size_t>(column));
}

TileRange tiles_touched(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c,
                        const TileGrid& grid) {
  const std::int32_t x_begin = std::max(0, first_pixel(std::min({a.x, b.x, c.x})));
  const std::int32_t y_begin = std::max(0, first_pixel(std::min({a.y, b.y, c.y})));
  const std::int32_t x_last =
      std::min(static_cast<std::int32_t>(grid.width) - 1, last_pixel(std::max({a.x, b.x, c.x})));
  const std::int32_t y_last =
      std::min(static_cast<std::int32_t>(grid.height) - 1, last_pixel(std::max({a.y, b.y, c.y})));
  if (x_begin > x_last || y_begin > y_last) return {};
  return {x_begin / tile_side, y_begin / tile_side, x_last / tile_side, y_last / tile_side};
}

/// Counter-clockwise on the screen (whose y points down): seen from outside.
bool is_front(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c) {
  return (std::int64_t(b.x) - a.x) * (std::int64_t(c.y) - a.y) <
         (std::int64_t(b.y) - a.y) * (std::int64_t(c.x) - a.x);
}

/// One picture being made.
class VisibilityPass {
 public:
  VisibilityPass(const Scene& scene, const Mesh& mesh, const Camera& camera, std::uint32_t width,
                 std::uint32_t height)
      : scene_(scene), mesh_(mesh), screen_(camera, width, height), grid_(width, height) {
    for (const Material& m : scene.materials) has_masks_ |= m.alpha_mode == AlphaMode::mask;
  }

  std::size_t run(const TileVisitor& visit) {
    memory_ = std::make_unique_for_overwrite<ScreenVertex[]>(mesh_.n_vertices());
    vertices_ = {memory_.get(), mesh_.n_vertices()};
    parallel_blocks(mesh_.n_vertices(), vertex_block, [&](std::size_t begin, std::size_t end) {
      project_vertices(screen_, std::span(mesh_.positions).subspan(begin, end - begin),
                       vertices_.subspan(begin, end - begin));
    });
    bins_.resize((mesh_.n_triangles() + triangle_block - 1) / triangle_block);
    parallel_blocks(mesh_.n_triangles(), triangle_block, [&](std::size_t begin, std::size_t end) {
      bins_[begin / triangle_block] = bin_triangles(begin, end);
    });
    std::vector<std::size_t> n_covered(grid_.n_tiles());
    parallel_blocks(grid_.n_tiles(), 1,
                    [&](std::size_t tile, std::size_t) { n_covered[tile] = draw_tile(tile, visit); });
    return std::accumulate(n_covered.begin(), n_covered.end(), std::size_t{0});
  }

 private:
  Bins bin_triangles(std::size_t begin, std::size_t end) const;
  std::size_t draw_tile(std::size_t tile_index, const TileVisitor& visit) const;
  void draw_with_masks(const ScreenTriangles& screen, std::span<const std::uint32_t> entries,
                       Tile& tile) const;
  bool is_opaque_at(std::uint32_t triangle, std::uint32_t x, std::uint32_t y) const;

  const Scene& scene_;
  const Mesh& mesh_;
  Screen screen_;
  TileGrid grid_;
  bool has_masks_ = false;
  std::unique_ptr<ScreenVertex[]> memory_;  ///< V.
  std::span<ScreenVertex> vertices_;        ///< `memory_`.
  std::vector<Bins> bins_;                  ///< One per block of triangles.
};

Bins VisibilityPass::bin_triangles(std::size_t begin, std::size_t end) const {
  struct Placed {
    std::uint32_t entry;
    TileRange tiles;
  };
  Bins bins;
  std::vector<Placed> placed;
  placed.reserve(end - begin);
  bins.begin.assign(grid_.n_tiles() + 2, 0);
  const auto place = [&](const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c,
                         std::uint32_t entry, bool is_double_sided) {
    const TileRange tiles = tiles_touched(a, b, c, grid_);
    if (tiles.row_begin > tiles.row_last || (!is_double_sided && !is_front(a, b, c))) return;
    placed.push_back({entry, tiles});
    for_each_tile(tiles, grid_, [&](std::size_t tile) { ++bins.begin[tile + 2]; });
  };

  std::vector<std::uint32_t> candidates;
  find_candidates(vertices_, mesh_.triangles, begin, end, candidates);
  for (const std::uint32_t triangle : candidates) {
    const glm::uvec3& t = mesh_.triangles[triangle];
    const ScreenVertex &a = vertices_[t[0]], &b = vertices_[t[1]], &c = vertices_[t[2]];
    const std::int32_t any = a.outcode | b.outcode | c.outcode;
    const bool is_double_sided = scene_.materials[mesh_.material_of(triangle)].is_double_sided;
    if ((any & clipped_if_any) == 0) {
      place(a, b, c, triangle, is_double_sided);
      continue;
    }
    const std::size_t first = bins.pieces.size();
    clip_triangle(screen_, {mesh_.positions[t[0]], mesh_.positions[t[1]], mesh_.positions[t[2]]},
                  bins.pieces);
    bins.piece_triangles.resize(bins.pieces.size(), triangle);
    for (std::size_t i = first; i < bins.pieces.size(); ++i) {
      const auto& v = bins.pieces[i].v;
      place(v[0], v[1], v[2], ScreenTriangles::is_piece | static_cast<std::uint32_t>(i), is_double_sided);
    }
  }

  for (std::size_t i = 2; i < bins.begin.size(); ++i) bins.begin[i] += bins.begin[i - 1];
  bins.entries.resize(bins.begin.back());
  for (const Placed& p : placed)
    for_each_tile(p.tiles, grid_, [&](std::size_t tile) { bins.entries[bins.begin[tile + 1]++] = p.entry; });
  bins.begin.pop_back();
  return bins;
}

/// Draws all that touches a tile, then finds where the pixels' rays hit. Returns the number of covered
/// pixels.
std::size_t VisibilityPass::draw_tile(std::size_t tile_index, const TileVisitor& visit) const {
  static thread_local Tile tile;  // its memory is used again, its contents are not
  static thread_local std::vector<glm::vec2> barycentrics(Tile::n_pixels);
  static thread_local std::vector<float> depths(Tile::n_pixels);
  tile.x = static_cast<std::int32_t>(tile_index % grid_.columns) * tile_side;
  tile.y = static_cast<std::int32_t>(tile_index / grid_.columns) * tile_side;
  tile.width = std::min(tile_side, static_cast<int>(grid_.width) - tile.x);
  tile.height = std::min(tile_side, static_cast<int>(grid_.height) - tile.y);
  VisibleTile seen;
  seen.x = static_cast<std::uint32_t>(tile.x), seen.y = static_cast<std::uint32_t>(tile.y);
  seen.width = static_cast<std::uint32_t>(tile.width), seen.height = static_cast<std::uint32_t>(tile.height);
  const bool is_empty = std::all_of(bins_.begin(), bins_.end(), [&](const Bins& bins) {
    return bins.begin[tile_index] == bins.begin[tile_index + 1];
  });
  if (is_empty) {
    visit(seen);
    return 0;
  }

  tile.clear();
  for (const Bins& bins : bins_) {
    const ScreenTriangles screen{vertices_, mesh_.triangles, bins.pieces, bins.piece_triangles};
    const auto entries =
        std::span(bins.entries)
            .subspan(bins.begin[tile_index], bins.begin[tile_index + 1] - bins.begin[tile_index]);
    if (has_masks_) {
      draw_with_masks(screen, entries, tile);
    } else {
      raster_triangles(screen, entries, tile);
    }
  }
  for (std::uint32_t row = 0; row < seen.height; ++row) {
    const std::size_t first = std::size_t{row} * tile_side;
    hit_row(mesh_, screen_.view, seen.x, seen.y + row, &tile.triangles[first], tile_side,
            &barycentrics[first], &depths[first]);
  }
  seen.triangles = std::span(tile.triangles).first(Tile::n_pixels);
  seen.barycentrics = barycentrics;
  seen.depths = depths;
  visit(seen);
  return Tile::n_pixels -
         static_cast<std::size_t>(std::count(seen.triangles.begin(), seen.triangles.end(), no_triangle));
}

void VisibilityPass::draw_with_masks(const ScreenTriangles& screen, std::span<const std::uint32_t> entries,
                                     Tile& tile) const {
  const PixelTest is_opaque = [this](std::uint32_t triangle, std::uint32_t x, std::uint32_t y) {
    return is_opaque_at(triangle, x, y);
  };
  for (const std::uint32_t& entry : entries) {
    const std::uint32_t material = mesh_.material_of(screen.triangle_of(entry));
    if (scene_.materials[material].alpha_mode == AlphaMode::mask) {
      raster_tested_triangle(screen, entry, is_opaque, tile);
    } else {
      raster_triangles(screen, std::span(&entry, 1), tile);
    }
  }
}

bool VisibilityPass::is_opaque_at(std::uint32_t triangle, std::uint32_t x, std::uint32_t y) const {
  const Material& material = scene_.materials[mesh_.material_of(triangle)];
  const glm::uvec3& t = mesh_.triangles[triangle];
  const glm::vec2 b(hit_triangle(screen_.view.pixel_ray(x, y), mesh_.positions[t[0]], mesh_.positions[t[1]],
                                 mesh_.positions[t[2]])
                        .barycentrics);
  const auto interpolated = [&](const auto& values) {
    return values[t[0]] + b.x * (values[t[1]] - values[t[0]]) + b.y * (values[t[2]] - values[t[0]]);
  };
  float opacity = material.opacity;
  if (!mesh_.opacities.empty()) opacity *= interpolated(mesh_.opacities);
  if (material.base_color_texture != no_texture) {
    const Texture& texture = scene_.textures[material.base_color_texture];
    const auto& texcoords = mesh_.texcoords[static_cast<std::size_t>(texture.texcoord_set)];
    if (!texcoords.empty()) opacity *= sample_texture(scene_, texture, interpolated(texcoords)).a;
  }
  return opacity >= material.alpha_cutoff;
}

void check_camera(const Camera& camera) {
  const glm::dmat4 m(camera.world_from_camera);
  bool is_usable = std::isfinite(camera.near_distance) && std::isfinite(camera.far_distance);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) is_usable &= std::isfinite(m[i][j]);
  if (!is_usable) throw InvalidOption("camera: a number is not finite");
  if (!(std::abs(glm::determinant(glm::dmat3(m))) > 1e-6))
    throw InvalidOption("camera: its axes do not span the space");
  if (camera.projection == Projection::perspective) {
    if (!(camera.vertical_fov_rad > 0 && camera.vertical_fov_rad < std::numbers::pi_v<float>))
      throw InvalidOption("camera: expected an angle between 0 and 180 degrees");
    if (!(camera.near_distance > 0)) throw InvalidOption("camera: the near plane must lie before the eye");
  } else if (!(camera.half_height > 0) || !std::isfinite(camera.half_height)) {
    throw InvalidOption("camera: the height of an orthographic view must be greater than 0");
  }
}

void check_view(const Mesh& mesh, const Camera& camera, std::uint32_t width, std::uint32_t height) {
  if (width == 0 || height == 0 || width > max_picture_side || height > max_picture_side)
    throw InvalidOption(
        fmt::format("picture: expected 1 to {} pixels a side, found {}x{}", max_picture_side, width, height));
  if (mesh.n_triangles() >= max_count || mesh.n_vertices() >= max_count)
    throw InvalidScene(fmt::format("render: expected less than {} triangles and vertices, found {} and {}",
                                   max_count, mesh.n_triangles(), mesh.n_vertices()));
  check_camera(camera);
}

}  // namespace

std::size_t visit_visible_tiles(const Scene& scene, const Mesh& mesh, const Camera& camera,
                                std::uint32_t width, std::uint32_t height, const TileVisitor& visit) {
  check_view(mesh, camera, width, height);
  return VisibilityPass(scene, mesh, camera, width, height).run(visit);
}

Visibility find_visibility(const Scene& scene, const Mesh& mesh, const Camera& camera, std::uint32_t width,
                           std::uint32_t height) {
  check_view(mesh, camera, width, height);
  const std::size_t n = std::size_t{width} * height;
  Visibility out;
  out.width = width;
  out.height = height;
  out.triangles.resize(n, no_triangle);
  out.barycentrics.resize(n, glm::vec2(0));
  out.depths.resize(n, std::numeric_limits<float>::infinity());
  out.n_covered = visit_visible_tiles(scene, mesh, camera, width, height, [&](const VisibleTile& tile) {
    if (tile.triangles.empty()) return;
    for (std::uint32_t row = 0; row < tile.height; ++row) {
      const std::size_t from = std::size_t{row} * tile_side, to = std::size_t{tile.y + row} * width + tile.x;
      std::copy_n(&tile.triangles[from], tile.width, &out.triangles[to]);
      std::copy_n(&tile.barycentrics[from], tile.width, &out.barycentrics[to]);
      std::copy_n(&tile.depths[from], tile.width, &out.depths[to]);
    }
  });
  return out;
}

}  // namespace lambake
