#include "lambake/geometry/normals.h"

#include <cmath>
#include <cstdint>

#include "lambake/core/bounds.h"
#include "lambake/core/parallel.h"

namespace lambake {
namespace {

constexpr std::size_t block_size = 4096;

/// A sum of unit normals shorter than this share of the sum of its weights has no direction: the faces
/// cancel.
constexpr double cancelled = 1e-6;

/// Twice the area vector of a triangle, in double: exact to a few ulp for float positions. (0,0,0) where
/// there is no area: shorter than 1e-12 of the longest edge squared, or not finite.
glm::dvec3 area_vector(const Mesh& mesh, const glm::uvec3& t) {
  const glm::dvec3 p0(mesh.positions[t[0]]), p1(mesh.positions[t[1]]), p2(mesh.positions[t[2]]);
  const glm::dvec3 e1 = p1 - p0, e2 = p2 - p0, e3 = p2 - p1;
  const glm::dvec3 cross = glm::cross(e1, e2);
  const double longest = std::max({glm::dot(e1, e1), glm::dot(e2, e2), glm::dot(e3, e3)});
  return glm::length(cross) > 1e-12 * longest ? cross : glm::dvec3(0);
}

/// The weighted normal that one corner of a triangle adds, and the weight.
struct Share {
  glm::dvec3 normal{0};
  double weight = 0;
};

Share corner_share(const Mesh& mesh, const glm::uvec3& t, int corner, NormalWeight weight) {
  const glm::dvec3 cross = area_vector(mesh, t);
  const double length = glm::length(cross);
  if (!(length > 0)) return {};
  const glm::dvec3 p(mesh.positions[t[corner]]);
  const glm::dvec3 e1 = glm::dvec3(mesh.positions[t[(corner + 1) % 3]]) - p;
  const glm::dvec3 e2 = glm::dvec3(mesh.positions[t[(corner + 2) % 3]]) - p;
  double w = 1;
  switch (weight) {
    case NormalWeight::angle:
      w = std::atan2(length, glm::dot(e1, e2));
      break;
    case NormalWeight::area:
      w = length;
      break;
    case NormalWeight::uniform:
      w = 1;
      break;
    case NormalWeight::max:
      w = length / (glm::dot(e1, e1) * glm::dot(e2, e2));
      break;
  }
  return {cross * (w / length), w};
}

/// The corners (3·triangle + corner) around each group of vertices that share a normal.
struct CornerTable {
  std::vector<std::uint32_t> begin;    ///< G + 1 offsets into `corners`.
  std::vector<std::uint32_t> corners;  ///< 3F, in the order of the triangles within each group.
};

CornerTable corners_by_group(const Mesh& mesh, const std::vector<std::uint32_t>& group_of,
                             std::size_t n_groups) {
  const auto group = [&](std::uint32_t v) { return group_of.empty() ? v : group_of[v]; };
  CornerTable table;
  table.begin.assign(n_groups + 2, 0);
  for (const glm::uvec3& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) ++table.begin[group(t[c]) + 2];
  for (std::size_t g = 2; g < table.begin.size(); ++g) table.begin[g] += table.begin[g - 1];
  table.corners.resize(3 * mesh.n_triangles());
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f)
    for (int c = 0; c < 3; ++c)
      table.corners[table.begin[group(mesh.triangles[f][c]) + 1]++] = static_cast<std::uint32_t>(3 * f + c);
  table.begin.pop_back();
  return table;
}

}  // namespace

VertexNormals vertex_normals(const Mesh& mesh, NormalWeight weight) {
  const std::vector<std::uint32_t>& group_of =
      mesh.normal_groups.empty() ? mesh.source_vertices : mesh.normal_groups;
  std::size_t n_groups = mesh.n_vertices();
  for (const std::uint32_t g : group_of) n_groups = std::max<std::size_t>(n_groups, g + 1);
  const CornerTable table = corners_by_group(mesh, group_of, n_groups);

  std::vector<glm::vec3> group_normals(n_groups, glm::vec3(0));
  parallel_blocks(n_groups, block_size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g) {
      glm::dvec3 sum(0);
      double weights = 0;
      for (std::uint32_t i = table.begin[g]; i < table.begin[g + 1]; ++i) {
        const std::uint32_t corner = table.corners[i];
        const Share share =
            corner_share(mesh, mesh.triangles[corner / 3], static_cast<int>(corner % 3), weight);
        sum += share.normal;
        weights += share.weight;
      }
      const double length = glm::length(sum);
      if (length > cancelled * weights) group_normals[g] = glm::vec3(sum / length);
    }
  });

  VertexNormals result;
  const auto is_undefined = [&](std::size_t g) {
    return table.begin[g] < table.begin[g + 1] && group_normals[g] == glm::vec3(0);
  };
  if (group_of.empty()) {
    for (std::size_t v = 0; v < n_groups; ++v) result.undefined += is_undefined(v);
    result.normals = std::move(group_normals);
    return result;
  }
  result.normals.resize(mesh.n_vertices());
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v) {
    result.normals[v] = group_normals[group_of[v]];
    result.undefined += is_undefined(group_of[v]);
  }
  return result;
}

std::vector<glm::vec3> face_normals(const Mesh& mesh) {
  std::vector<glm::vec3> normals(mesh.n_triangles(), glm::vec3(0));
  parallel_blocks(mesh.n_triangles(), block_size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const glm::dvec3 cross = area_vector(mesh, mesh.triangles[f]);
      const double length = glm::length(cross);
      if (length > 0) normals[f] = glm::vec3(cross / length);
    }
  });
  return normals;
}

}  // namespace lambake
