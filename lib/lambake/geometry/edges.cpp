#include "lambake/geometry/edges.h"

#include <algorithm>
#include <tuple>

namespace lambake {

std::vector<EdgeSide> sorted_edge_sides(const Mesh& mesh) {
  std::vector<EdgeSide> sides;
  sides.reserve(3 * mesh.n_triangles());
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    std::uint32_t v[3];
    for (int c = 0; c < 3; ++c) v[c] = mesh.source_vertex_of(mesh.triangles[f][c]);
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
    for (std::uint32_t c = 0; c < 3; ++c) {
      const std::uint32_t from = v[c], to = v[(c + 1) % 3];
      sides.push_back(
          {std::min(from, to), std::max(from, to), static_cast<std::uint32_t>(3 * f) + c, from < to});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const EdgeSide& a, const EdgeSide& b) {
    return std::tie(a.low, a.high, a.corner) < std::tie(b.low, b.high, b.corner);
  });
  return sides;
}

}  // namespace lambake
