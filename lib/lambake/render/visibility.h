#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

#include "lambake/scene/camera.h"
#include "lambake/scene/scene.h"

namespace lambake {

inline constexpr std::uint32_t no_triangle = std::numeric_limits<std::uint32_t>::max();

/// Who is seen in each pixel: the triangle nearest at its centre. W×H, row by row from the top.
///
/// A triangle covers a pixel if the centre is inside, by the top-left rule on its edges: triangles that share
/// an edge cover each pixel exactly once. Triangles are clipped at the near (and far) plane. Single-sided
/// materials are not seen from behind; pixels whose texture opacity is below the cutoff of an AlphaMode::mask
/// material show what is behind; AlphaMode::blend is drawn as opaque. Triangles with a vertex that is not
/// finite are not drawn. At equal depth the lower triangle index is seen.
struct Visibility {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint32_t> triangles;  ///< W·H indices of triangles, or no_triangle.
  std::vector<glm::vec2> barycentrics;   ///< W·H: perspective-correct weights of the corners 1 and 2.
  std::vector<float> depths;             ///< W·H distances along the view axis; infinity where nothing is.
  std::size_t n_covered = 0;             ///< Pixels with a triangle.
};

/// Largest width and height of a picture.
inline constexpr std::uint32_t max_picture_side = 16384;

/// @param scene   for the materials (sidedness, masks); its own mesh is not used.
/// @param mesh    what is drawn: the scene's, or one made by baking.
/// @param width,height  1 to max_picture_side.
/// @throws InvalidOption for another size or a camera out of its range; InvalidScene for 2^29 triangles.
/// Vertices are snapped to 1/256 pixel. Deterministic for any number of threads.
Visibility find_visibility(const Scene& scene, const Mesh& mesh, const Camera& camera, std::uint32_t width,
                           std::uint32_t height);

/// Pictures are drawn in squares of this many pixels a side.
inline constexpr int tile_side = 64;

/// Who is seen in a part of a picture. Arrays are rows of tile_side, tile_side² long, whatever the width;
/// they are empty if nothing is seen.
struct VisibleTile {
  std::uint32_t x = 0, y = 0;                ///< Its first pixel.
  std::uint32_t width = 0, height = 0;       ///< At most tile_side; less at the picture's end.
  std::span<const std::uint32_t> triangles;  ///< As in Visibility; no_triangle beyond width and height.
  std::span<const glm::vec2> barycentrics;   ///< Undefined beyond the height.
  std::span<const float> depths;             ///< The same.
};
using TileVisitor = std::function<void(const VisibleTile&)>;

/// The same, handed out tile by tile while it is in cache, for who needs it once: nothing of the size of the
/// picture is written. `visit` is called once for each tile, from several threads at once, and must not run
/// parallel loops of its own. Returns the number of pixels with a triangle. Errors as of find_visibility().
std::size_t visit_visible_tiles(const Scene& scene, const Mesh& mesh, const Camera& camera,
                                std::uint32_t width, std::uint32_t height, const TileVisitor& visit);

}  // namespace lambake
