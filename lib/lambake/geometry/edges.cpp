#include "lambake/geometry/edges.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "lambake/core/parallel.h"

namespace lambake {

std::vector<EdgeSide> sorted_edge_sides(const Mesh& mesh) {
  const auto for_each_side = [&](auto&& visit) {
    for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
      std::uint32_t v[3];
      for (int c = 0; c < 3; ++c) v[c] = mesh.source_vertex_of(mesh.triangles[f][c]);
      if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
      for (std::uint32_t c = 0; c < 3; ++c) {
        const std::uint32_t from = v[c], to = v[(c + 1) % 3];
        visit(EdgeSide{std::min(from, to), std::max(from, to), static_cast<std::uint32_t>(3 * f) + c,
                       from < to});
      }
    }
  };
  // Those of each lower vertex come together by counting: from starts[low + 1], which filling moves to where
  // the next begin.
  const std::size_t n_source_vertices = count_of_numbers(mesh.source_vertices, mesh.n_vertices());
  std::vector<std::size_t> starts(n_source_vertices + 2, 0);
  for_each_side([&](const EdgeSide& side) { ++starts[side.low + 2]; });
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  std::vector<EdgeSide> sides(starts.back());
  for_each_side([&](const EdgeSide& side) { sides[starts[side.low + 1]++] = side; });
  parallel_blocks(n_source_vertices, 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t low = begin; low < end; ++low)
      std::sort(sides.data() + starts[low], sides.data() + starts[low + 1],
                [](const EdgeSide& a, const EdgeSide& b) {
                  return std::tie(a.high, a.corner) < std::tie(b.high, b.corner);
                });
  });
  return sides;
}

}  // namespace lambake
