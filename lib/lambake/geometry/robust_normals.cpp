#include "lambake/geometry/robust_normals.h"

#include <CGAL/Min_sphere_of_points_d_traits_3.h>
#include <CGAL/Min_sphere_of_spheres_d.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace lambake {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Ball = CGAL::Min_sphere_of_spheres_d<CGAL::Min_sphere_of_points_d_traits_3<Kernel, double>>;

/// A centre this near to 0 is none: the normals do not fit into a half space.
constexpr double shortest_center = 1e-6;

}  // namespace

VertexNormals robust_normals(const Mesh& mesh) {
  const std::vector<std::uint32_t>& group_of = mesh.shared_normals();
  const auto group = [&](std::uint32_t v) { return group_of.empty() ? v : group_of[v]; };
  const std::vector<glm::vec3> normals = face_normals(mesh);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> faces;  // (group, face) of each corner
  faces.reserve(3 * mesh.n_triangles());
  for (std::uint32_t f = 0; f < mesh.n_triangles(); ++f)
    for (int c = 0; c < 3; ++c) faces.emplace_back(group(mesh.triangles[f][c]), f);
  std::sort(faces.begin(), faces.end());

  const std::size_t n_groups = count_of_numbers(group_of, mesh.n_vertices());
  std::vector<glm::vec3> group_normals(n_groups, glm::vec3(0));
  std::vector<char> has_face(n_groups, 0);
  std::vector<Kernel::Point_3> points;
  for (std::size_t i = 0; i < faces.size();) {
    const std::uint32_t g = faces[i].first;
    points.clear();
    for (; i < faces.size() && faces[i].first == g; ++i) {
      const glm::vec3& n = normals[faces[i].second];
      if (n != glm::vec3(0)) points.emplace_back(n.x, n.y, n.z);
    }
    has_face[g] = 1;
    if (points.empty()) continue;
    Ball ball(points.begin(), points.end());
    const auto center = ball.center_cartesian_begin();
    const glm::dvec3 n(center[0], center[1], center[2]);
    if (glm::length(n) > shortest_center) group_normals[g] = glm::vec3(glm::normalize(n));
  }

  VertexNormals result;
  result.normals.resize(mesh.n_vertices(), glm::vec3(0));
  for (std::uint32_t v = 0; v < mesh.n_vertices(); ++v) {
    const std::uint32_t g = group(v);
    result.normals[v] = group_normals[g];
    result.undefined += has_face[g] && group_normals[g] == glm::vec3(0);
  }
  return result;
}

}  // namespace lambake
