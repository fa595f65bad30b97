#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "lambake/core/bounds.h"

/// Points in ranges that lie near each other and face alike.
namespace lambake {

struct KeyedPoint {
  std::uint32_t key, point;
};

/// The points that a positional light can reach (their positions finite, their normals unit vectors), those
/// with near keys next to each other: by the largest axis of the normal, then by place. Parallel.
/// @param box  of the positions.
std::vector<KeyedPoint> sort_points(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                                    const Bounds& box);

/// Sorted points [begin, end).
struct PointRange {
  std::size_t begin, end;
  std::size_t size() const { return end - begin; }
};

/// Ranges of at most RangeTree::tile_size points that together are all, cut between the cells of the keys
/// rather than anywhere: a range over the border of two large cells would be wide. What is small joins its
/// neighbour.
std::vector<PointRange> cut_into_tiles(std::span<const KeyedPoint> order);

/// A tile's ranges and those within them.
struct RangeTree {
  /// At most so many points are dealt with together at first, and at last; each level has a quarter of the
  /// points of the one above.
  static constexpr std::size_t tile_size = 8192, leaf_size = 128, n_children = 4, n_levels = 4;
  static_assert(tile_size == leaf_size * n_children * n_children * n_children);

  /// A range of slots, in depth-first order: a node's first child follows it.
  struct Node {
    std::size_t begin, end;  ///< Slots; `begin` is a multiple of 16.
    std::size_t next;        ///< The node after all below this one.
  };
  std::vector<Node> nodes;
  std::vector<std::uint32_t> slots;  ///< The points; each leaf is filled up to 16 with its last one.

  // Memory that build_range_tree() uses again.
  std::vector<KeyedPoint> by_normal;                     ///< The tile's points, where normals turn quickly.
  std::array<std::vector<PointRange>, n_levels> ranges;  ///< By level.

  bool is_leaf(std::size_t node) const { return nodes[node].next == node + 1; }
};

/// Makes the tree of a tile, which holds at least one point. Ranges are of neighbours, or, where normals turn
/// much among neighbours, of points anywhere in half of the tile that face alike.
/// @param unit  a typical distance of a light.
void build_range_tree(std::span<const KeyedPoint> order, const PointRange& tile, float unit,
                      std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                      RangeTree& tree);

}  // namespace lambake
