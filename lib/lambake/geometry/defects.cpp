#include "lambake/geometry/defects.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <numeric>
#include <span>

#include "lambake/core/bounds.h"
#include "lambake/core/parallel.h"
#include "lambake/core/value_numbers.h"
#include "lambake/geometry/disjoint_sets.h"
#include "lambake/geometry/normal_sums.h"

namespace lambake {
namespace {

glm::uvec3 source_triangle(const Mesh& mesh, std::size_t f) {
  const glm::uvec3& t = mesh.triangles[f];
  return {mesh.source_vertex_of(t.x), mesh.source_vertex_of(t.y), mesh.source_vertex_of(t.z)};
}

bool repeats_a_vertex(const glm::uvec3& t) {
  return t.x == t.y || t.y == t.z || t.z == t.x;
}

/// One side of a triangle as its lower vertex sees it, as a number to sort by: the other vertex · 2, plus 1
/// if the side runs towards the lower one; below that the triangle's third vertex.
using Side = std::uint64_t;

Side make_side(std::uint32_t from, std::uint32_t to, std::uint32_t opposite) {
  return Side{std::max(from, to)} << 33 | Side{from > to} << 32 | opposite;
}
std::uint32_t other_vertex(Side side) {
  return static_cast<std::uint32_t>(side >> 33);
}
bool is_backward(Side side) {
  return (side >> 32 & 1) != 0;
}
std::uint32_t opposite_vertex(Side side) {
  return static_cast<std::uint32_t>(side);
}

/// The sides of all triangles that name three different vertices, by their lower vertex.
struct SideTable {
  std::vector<std::size_t> begins;  // V + 1.
  std::unique_ptr<Side[]> sides;

  std::span<Side> sides_of(std::size_t v) const { return {&sides[begins[v]], begins[v + 1] - begins[v]}; }
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
  table.sides = std::make_unique_for_overwrite<Side[]>(table.begins.back());
  for_each_side([&](std::uint32_t from, std::uint32_t to, std::uint32_t opposite) {
    table.sides[--table.begins[std::min(from, to)]] = make_side(from, to, opposite);
  });
  return table;
}

/// For the few sides that a vertex has; any number is sorted.
void sort_sides(std::span<Side> sides) {
  constexpr std::size_t few = 24;
  if (sides.size() > few) return std::sort(sides.begin(), sides.end());
  for (std::size_t i = 1; i < sides.size(); ++i) {
    const Side side = sides[i];
    std::size_t place = i;
    for (; place > 0 && sides[place - 1] > side; --place) sides[place] = sides[place - 1];
    sides[place] = side;
  }
}

/// Counts what one vertex's sides tell: its edges to higher vertices, and the triangles whose lowest it is.
void count_edges(std::span<Side> sides, Defects& d) {
  sort_sides(sides);
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    const std::uint32_t vertex = other_vertex(sides[begin]);
    std::size_t n_backward = 0;
    for (; end < sides.size() && other_vertex(sides[end]) == vertex; ++end)
      n_backward += is_backward(sides[end]);
    const std::size_t n = end - begin;
    d.border_edges += n == 1;
    d.non_manifold_edges += n > 2;
    d.conflicting_edges += n_backward > 1 || n - n_backward > 1;
    // Each triangle is looked at from the edge of its two lowest vertices.
    if (n == 2) {
      const std::uint32_t opposite = opposite_vertex(sides[begin]);
      d.duplicate_faces += opposite > vertex && opposite == opposite_vertex(sides[begin + 1]);
    }
    if (n <= 2) continue;
    // Forward and backward sides are each sorted by the third vertex.
    std::size_t forward = begin, backward = end - n_backward;
    std::uint32_t last = 0;  // Opposite to an edge there is never vertex 0 above it.
    while (forward < end - n_backward || backward < end) {
      const bool takes_forward =
          backward == end ||
          (forward < end - n_backward && opposite_vertex(sides[forward]) < opposite_vertex(sides[backward]));
      const std::uint32_t opposite = opposite_vertex(sides[takes_forward ? forward++ : backward++]);
      if (opposite <= vertex) continue;
      d.duplicate_faces += opposite == last;
      last = opposite;
    }
  }
}

void count_all_edges(const Mesh& mesh, std::size_t n_vertices, Defects& d) {
  const SideTable table = make_side_table(mesh, n_vertices);
  constexpr std::size_t block = 16384;
  std::vector<Defects> parts((n_vertices + block - 1) / block);
  parallel_blocks(n_vertices, block, [&](std::size_t begin, std::size_t end) {
    Defects part;
    for (std::size_t v = begin; v < end; ++v) count_edges(table.sides_of(v), part);
    parts[begin / block] = part;
  });
  for (const Defects& part : parts) {
    d.border_edges += part.border_edges;
    d.non_manifold_edges += part.non_manifold_edges;
    d.conflicting_edges += part.conflicting_edges;
    d.duplicate_faces += part.duplicate_faces;
  }
}

/// Triangles of three different vertices without area.
std::size_t count_zero_area_faces(const Mesh& mesh) {
  constexpr std::size_t block = 16384;
  std::atomic<std::size_t> n{0};
  parallel_blocks(mesh.n_triangles(), block, [&](std::size_t begin, std::size_t end) {
    const std::span<const glm::uvec3> triangles(mesh.triangles);
    if (have_area(mesh.positions, triangles.subspan(begin, end - begin))) return;
    for (std::size_t f = begin; f < end; ++f) {
      const glm::uvec3& t = mesh.triangles[f];
      n += !repeats_a_vertex(source_triangle(mesh, f)) &&
           area_vector(mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]) == glm::dvec3(0);
    }
  });
  return n;
}

/// The positions of the file's vertices: those of the mesh, or made from them in `storage`.
std::span<const glm::vec3> source_positions(const Mesh& mesh, std::size_t n_source,
                                            std::vector<glm::vec3>& storage) {
  if (mesh.source_vertices.empty()) return mesh.positions;
  storage.resize(n_source);
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v) storage[mesh.source_vertices[v]] = mesh.positions[v];
  return storage;
}

std::size_t count_components(const Mesh& mesh, const std::vector<char>& is_used) {
  DisjointSets sets(is_used.size());
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    const glm::uvec3 t = source_triangle(mesh, f);
    sets.unite(t.x, t.y);
    sets.unite(t.x, t.z);
  }
  std::size_t n = 0;
  for (std::uint32_t v = 0; v < is_used.size(); ++v) n += is_used[v] && sets.find(v) == v;
  return n;
}

std::size_t count_duplicate_positions(std::span<const glm::vec3> positions) {
  ValueNumbers<3> numbers;
  std::size_t n = 0;
  for (const glm::vec3& p : positions) {
    if (!is_finite(p)) continue;
    numbers.number_of({p.x + 0.0f, p.y + 0.0f, p.z + 0.0f});
    ++n;
  }
  return n - numbers.size();
}

}  // namespace

Defects find_defects(const Mesh& mesh, bool with_parts) {
  Defects d;
  const std::size_t n_source = count_of_numbers(mesh.source_vertices, mesh.n_vertices());

  std::vector<char> is_used(n_source, 0);
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    const glm::uvec3 t = source_triangle(mesh, f);
    is_used[t.x] = is_used[t.y] = is_used[t.z] = 1;
    d.repeated_vertex_faces += repeats_a_vertex(t);
  }
  d.zero_area_faces = count_zero_area_faces(mesh);
  std::vector<glm::vec3> storage;
  const std::span<const glm::vec3> positions = source_positions(mesh, n_source, storage);
  for (std::size_t v = 0; v < n_source; ++v) {
    d.isolated_vertices += !is_used[v];
    d.non_finite_vertices += !is_finite(positions[v]);
  }
  count_all_edges(mesh, n_source, d);
  if (with_parts) {
    d.components = count_components(mesh, is_used);
    d.duplicate_positions = count_duplicate_positions(positions);
  }
  d.is_closed = mesh.n_triangles() > 0 && d.border_edges == 0;
  d.is_consistently_wound = d.conflicting_edges == 0;
  return d;
}

}  // namespace lambake
