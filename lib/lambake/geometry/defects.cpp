#include "lambake/geometry/defects.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "lambake/core/bounds.h"
#include "lambake/geometry/edges.h"
#include "lambake/geometry/normals.h"

namespace lambake {
namespace {

std::uint32_t find_root(std::vector<std::uint32_t>& parents, std::uint32_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace

Defects find_defects(const Mesh& mesh) {
  Defects d;
  std::uint32_t n_source = 0;
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v)
    n_source = std::max(n_source, mesh.source_vertex_of(v) + 1);

  std::vector<std::uint32_t> parents(n_source);
  std::iota(parents.begin(), parents.end(), 0U);
  std::vector<bool> is_used(n_source, false);
  std::vector<std::array<std::uint32_t, 3>> keys;
  keys.reserve(mesh.n_triangles());
  const std::vector<glm::vec3> normals = face_normals(mesh);
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    std::array<std::uint32_t, 3> key;
    for (int c = 0; c < 3; ++c)
      key[static_cast<std::size_t>(c)] = mesh.source_vertex_of(mesh.triangles[f][c]);
    for (const std::uint32_t v : key) {
      is_used[v] = true;
      const std::uint32_t a = find_root(parents, key[0]), b = find_root(parents, v);
      parents[std::max(a, b)] = std::min(a, b);
    }
    const bool repeats = key[0] == key[1] || key[1] == key[2] || key[2] == key[0];
    d.repeated_vertex_faces += repeats;
    d.zero_area_faces += !repeats && normals[f] == glm::vec3(0);
    std::sort(key.begin(), key.end());
    if (!repeats) keys.push_back(key);
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 1; i < keys.size(); ++i) d.duplicate_faces += keys[i] == keys[i - 1];

  std::vector<glm::vec3> source_positions(n_source);
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v)
    source_positions[mesh.source_vertex_of(v)] = mesh.positions[v];
  for (std::uint32_t v = 0; v < n_source; ++v) {
    d.isolated_vertices += !is_used[v];
    d.components += is_used[v] && find_root(parents, v) == v;
    d.non_finite_vertices += !is_finite(source_positions[v]);
  }
  // Compared as bits, with −0 made +0, so that the order is total.
  std::vector<std::array<std::uint32_t, 3>> bits;
  bits.reserve(n_source);
  for (const glm::vec3& p : source_positions)
    if (is_finite(p))
      bits.push_back({std::bit_cast<std::uint32_t>(p.x + 0.0f), std::bit_cast<std::uint32_t>(p.y + 0.0f),
                      std::bit_cast<std::uint32_t>(p.z + 0.0f)});
  std::sort(bits.begin(), bits.end());
  for (std::size_t i = 1; i < bits.size(); ++i) d.duplicate_positions += bits[i] == bits[i - 1];

  const std::vector<EdgeSide> sides = sorted_edge_sides(mesh);
  for_each_edge(sides, [&](std::span<const EdgeSide> edge) {
    d.border_edges += edge.size() == 1;
    d.non_manifold_edges += edge.size() > 2;
    const auto n_forward = static_cast<std::size_t>(
        std::count_if(edge.begin(), edge.end(), [](const EdgeSide& s) { return s.is_forward; }));
    d.conflicting_edges += n_forward > 1 || edge.size() - n_forward > 1;
  });
  d.is_closed = mesh.n_triangles() > 0 && d.border_edges == 0;
  d.is_consistently_wound = d.conflicting_edges == 0;
  return d;
}

}  // namespace lambake
