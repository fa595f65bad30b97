#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lambake/scene/mesh.h"

namespace lambake {

/// One side of a triangle, between two vertices of the file.
struct EdgeSide {
  std::uint32_t low = 0, high = 0;  ///< Its source vertices, low < high.
  std::uint32_t corner = 0;         ///< 3·triangle + c: the side runs from corner c to corner (c + 1) % 3.
  bool is_forward = true;           ///< It runs from `low` to `high`.
};

/// The sides of all triangles that name three different source vertices, sorted by (low, high, corner): the
/// sides of one edge lie together. O(F) but for the sorting of what one vertex has.
std::vector<EdgeSide> sorted_edge_sides(const Mesh& mesh);

/// Calls `visit(std::span<const EdgeSide>)` once for each edge.
template <typename Visit>
void for_each_edge(std::span<const EdgeSide> sides, Visit&& visit) {
  for (std::size_t begin = 0; begin < sides.size();) {
    std::size_t end = begin + 1;
    while (end < sides.size() && sides[end].low == sides[begin].low && sides[end].high == sides[begin].high)
      ++end;
    visit(sides.subspan(begin, end - begin));
    begin = end;
  }
}

}  // namespace lambake
