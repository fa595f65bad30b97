#include "lambake/geometry/defects.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <span>

#include "lambake/core/bounds.h"
#include "lambake/core/parallel.h"
#include "lambake/geometry/normals.h"

namespace lambake {
namespace {

glm::uvec3 source_triangle(const Mesh& mesh, std::size_t f) {
  const glm::uvec3& t = mesh.triangles[f];
  return {mesh.source_vertex_of(t.x), mesh.source_vertex_of(t.y), mesh.source_vertex_of(t.z)};
}

bool repeats_a_vertex(const glm::uvec3& t) {
  return t.x == t.y || t.y == t.z || t.z == t.x;
}

/// One side of a triangle as its lower vertex sees it.
struct Side {
  std::uint32_t high;      // The other vertex · 2, plus 1 if the side runs towards the lower one.
  std::uint32_t opposite;  // The triangle's third vertex.
};

/// The sides of all triangles that name three different vertices, by their lower vertex.
struct SideTable {
  std::vector<std::size_t> begins;  // V + 1.
  std::vector<Side> sides;
};

SideTable make_side_table(const Mesh& mesh, std::size_t n_vertices) {
  SideTable table;
  table.begins.assign(n_vertices + 1, 0);
  const auto for_each_side = [&mesh](auto&& visit) {
    for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
      const glm::uvec3 t = source_triangle(mesh, f);
      if (repeats_a_vertex(t)) continue;
      visit(t.x, t.y, t.z);
      visit(t.y, t.z, t.x);
      visit(t.z, t.x, t.y);
    }
  };
  for_each_side(
      [&](std::uint32_t from, std::uint32_t to, std::uint32_t) { ++table.begins[std::min(from, to)]; });
  // Filled from the back, each begin ends where it belongs.
  std::partial_sum(table.begins.begin(), table.begins.end(), table.begins.begin());
  table.sides.resize(table.begins.back());
  for_each_side([&](std::uint32_t from, std::uint32_t to, std::uint32_t opposite) {
    table.sides[--table.begins[std::min(from, to)]] = {std::max(from, to) * 2 + (from > to ? 1U : 0U),
                                                       opposite};
  });
  return table;
}

/// Counts what one vertex's sides tell: its edges to higher vertices, and the triangles whose lowest it is.
void count_edges(std::span<Side> sides, Defects& d) {
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.high != b.high ? a.high < b.high : a.opposite < b.opposite;
  });
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    const std::uint32_t vertex = sides[begin].high / 2;
    std::size_t n_backward = 0;
    for (; end < sides.size() && sides[end].high / 2 == vertex; ++end) n_backward += sides[end].high % 2;
    const std::size_t n = end - begin;
    d.border_edges += n == 1;
    d.non_manifold_edges += n > 2;
    d.conflicting_edges += n_backward > 1 || n - n_backward > 1;
    if (n < 2) continue;
    // Each triangle is looked at from the edge of its two lowest vertices. Forward and backward sides are
    // each sorted by the third vertex.
    std::size_t forward = begin, backward = end - n_backward;
    std::uint32_t last = 0;  // Opposite to an edge there is never vertex 0 above it.
    while (forward < end - n_backward || backward < end) {
      const bool takes_forward = backward == end || (forward < end - n_backward &&
                                                     sides[forward].opposite < sides[backward].opposite);
      const std::uint32_t opposite = sides[takes_forward ? forward++ : backward++].opposite;
      if (opposite <= vertex) continue;
      d.duplicate_faces += opposite == last;
      last = opposite;
    }
  }
}

void count_all_edges(const Mesh& mesh, std::size_t n_vertices, Defects& d) {
  SideTable table = make_side_table(mesh, n_vertices);
  constexpr std::size_t block = 16384;
  std::vector<Defects> parts((n_vertices + block - 1) / block);
  parallel_blocks(n_vertices, block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      count_edges(std::span(table.sides).subspan(table.begins[v], table.begins[v + 1] - table.begins[v]),
                  parts[begin / block]);
  });
  for (const Defects& part : parts) {
    d.border_edges += part.border_edges;
    d.non_manifold_edges += part.non_manifold_edges;
    d.conflicting_edges += part.conflicting_edges;
    d.duplicate_faces += part.duplicate_faces;
  }
}

std::uint32_t find_root(std::vector<std::uint32_t>& parents, std::uint32_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

std::size_t count_components(const Mesh& mesh, const std::vector<char>& is_used) {
  std::vector<std::uint32_t> parents(is_used.size());
  std::iota(parents.begin(), parents.end(), 0U);
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    const glm::uvec3 t = source_triangle(mesh, f);
    for (const std::uint32_t v : {t.y, t.z}) {
      const std::uint32_t a = find_root(parents, t.x), b = find_root(parents, v);
      parents[std::max(a, b)] = std::min(a, b);
    }
  }
  std::size_t n = 0;
  for (std::uint32_t v = 0; v < parents.size(); ++v) n += is_used[v] && parents[v] == v;
  return n;
}

std::size_t count_duplicate_positions(const std::vector<glm::vec3>& positions) {
  // Compared as bits, with −0 made +0, so that the order is total.
  std::vector<std::array<std::uint32_t, 3>> bits;
  bits.reserve(positions.size());
  for (const glm::vec3& p : positions)
    if (is_finite(p))
      bits.push_back({std::bit_cast<std::uint32_t>(p.x + 0.0f), std::bit_cast<std::uint32_t>(p.y + 0.0f),
                      std::bit_cast<std::uint32_t>(p.z + 0.0f)});
  std::sort(bits.begin(), bits.end());
  std::size_t n = 0;
  for (std::size_t i = 1; i < bits.size(); ++i) n += bits[i] == bits[i - 1];
  return n;
}

}  // namespace

Defects find_defects(const Mesh& mesh, bool with_parts) {
  Defects d;
  std::uint32_t n_source = 0;
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v)
    n_source = std::max(n_source, mesh.source_vertex_of(v) + 1);

  std::vector<char> is_used(n_source, 0);
  const std::vector<glm::vec3> normals = face_normals(mesh);
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    const glm::uvec3 t = source_triangle(mesh, f);
    is_used[t.x] = is_used[t.y] = is_used[t.z] = 1;
    const bool repeats = repeats_a_vertex(t);
    d.repeated_vertex_faces += repeats;
    d.zero_area_faces += !repeats && normals[f] == glm::vec3(0);
  }
  std::vector<glm::vec3> source_positions(n_source);
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v)
    source_positions[mesh.source_vertex_of(v)] = mesh.positions[v];
  for (std::uint32_t v = 0; v < n_source; ++v) {
    d.isolated_vertices += !is_used[v];
    d.non_finite_vertices += !is_finite(source_positions[v]);
  }
  count_all_edges(mesh, n_source, d);
  if (with_parts) {
    d.components = count_components(mesh, is_used);
    d.duplicate_positions = count_duplicate_positions(source_positions);
  }
  d.is_closed = mesh.n_triangles() > 0 && d.border_edges == 0;
  d.is_consistently_wound = d.conflicting_edges == 0;
  return d;
}

}  // namespace lambake
