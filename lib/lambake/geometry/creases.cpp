#include "lambake/geometry/creases.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

#include "lambake/geometry/disjoint_sets.h"
#include "lambake/geometry/edges.h"
#include "lambake/geometry/normal_sums.h"
#include "lambake/geometry/normals.h"

namespace lambake {
namespace {

/// Normals that lean by 90 degrees or more are of faces wound against each other, not of edges.
bool is_smoothed(const Mesh& mesh, const glm::uvec3& t) {
  constexpr double cos_40_degrees = 0.766;
  const glm::dvec3 cross = area_vector(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]);
  const double least = cos_40_degrees * glm::length(cross);
  for (int c = 0; c < 3; ++c) {
    const double along = glm::dot(glm::dvec3(mesh.normals[t[c]]), cross);
    if (along > 0 && along < least) return true;
  }
  return false;
}

}  // namespace

std::size_t split_creases(Mesh& mesh, float crease_angle_rad) {
  const std::vector<glm::vec3> normals = face_normals(mesh);
  const auto has_direction = [&](std::size_t f) { return normals[f] != glm::vec3(0); };
  const float cos_crease = std::cos(crease_angle_rad);

  // Corners of faces that meet smoothly at an edge belong together at both of its ends.
  DisjointSets sets(3 * mesh.n_triangles());
  const std::vector<EdgeSide> sides = sorted_edge_sides(mesh);
  const auto corner_at = [&](const EdgeSide& side, bool at_low) {
    const std::uint32_t next = side.corner / 3 * 3 + (side.corner % 3 + 1) % 3;
    return side.is_forward == at_low ? side.corner : next;
  };
  for_each_edge(sides, [&](std::span<const EdgeSide> edge) {
    if (edge.size() != 2) return;
    const std::size_t f = edge[0].corner / 3, g = edge[1].corner / 3;
    if (!has_direction(f) || !has_direction(g) || glm::dot(normals[f], normals[g]) < cos_crease) return;
    for (const bool at_low : {true, false})
      sets.unite(corner_at(edge[0], at_low), corner_at(edge[1], at_low));
  });

  // A corner without a direction takes the first set at its vertex, or the first corner where none has one:
  // it needs no copy of its own.
  constexpr std::uint32_t none = ~0U;
  std::vector<std::uint32_t> first_set(mesh.n_vertices(), none);
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f)
    for (std::uint32_t c = 0; c < 3; ++c) {
      std::uint32_t& first = first_set[mesh.triangles[f][c]];
      if (first == none && has_direction(f)) first = sets.find(static_cast<std::uint32_t>(3 * f) + c);
    }

  struct Corner {
    std::uint32_t vertex, set, corner;
  };
  std::vector<Corner> corners;
  corners.reserve(3 * mesh.n_triangles());
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f)
    for (std::uint32_t c = 0; c < 3; ++c) {
      const std::uint32_t corner = static_cast<std::uint32_t>(3 * f) + c, vertex = mesh.triangles[f][c];
      if (first_set[vertex] == none) first_set[vertex] = corner;
      corners.push_back({vertex, has_direction(f) ? sets.find(corner) : first_set[vertex], corner});
    }
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
    return std::tie(a.vertex, a.set, a.corner) < std::tie(b.vertex, b.set, b.corner);
  });

  const std::size_t n_before = mesh.n_vertices();
  mesh.normals.clear();
  mesh.normal_groups.resize(n_before);
  // Groups are numbered by their lowest corner; vertices in no face keep to themselves beyond them.
  std::iota(mesh.normal_groups.begin(), mesh.normal_groups.end(),
            static_cast<std::uint32_t>(3 * mesh.n_triangles()));
  for (std::size_t i = 0; i < corners.size();) {
    const std::uint32_t vertex = corners[i].vertex, set = corners[i].set;
    const bool is_first = i == 0 || corners[i - 1].vertex != vertex;
    const std::uint32_t target = is_first ? vertex : append_vertex_copy(mesh, vertex);
    mesh.normal_groups[target] = set;
    for (; i < corners.size() && corners[i].vertex == vertex && corners[i].set == set; ++i)
      mesh.triangles[corners[i].corner / 3][static_cast<int>(corners[i].corner % 3)] = target;
  }
  return mesh.n_vertices() - n_before;
}

std::size_t count_smoothed_faces(const Mesh& mesh) {
  const auto count = [&](std::size_t step) {
    std::size_t n = 0;
    for (std::size_t f = 0; f < mesh.n_triangles(); f += step) n += is_smoothed(mesh, mesh.triangles[f]);
    return n;
  };
  const std::size_t step = 1 + mesh.n_triangles() / 20000, n_seen = (mesh.n_triangles() + step - 1) / step;
  if (10 * count(step) < n_seen) return 0;
  return count(1);
}

}  // namespace lambake
