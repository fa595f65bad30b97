#include "lambake/geometry/robust_normals.h"

#include <CGAL/Min_sphere_of_points_d_traits_3.h>
#include <CGAL/Min_sphere_of_spheres_d.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

namespace lambake {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Ball = CGAL::Min_sphere_of_spheres_d<CGAL::Min_sphere_of_points_d_traits_3<Kernel, double>>;

/// A centre this near to 0 is none: the normals do not fit into a half space.
constexpr double shortest_center = 1e-6;

/// The direction whose largest angle to the normals is the least, or (0,0,0) where that is a right one.
/// @param normals  of unit length; are sorted, so that their order does not matter.
glm::vec3 middle_of(std::vector<glm::vec3>& normals) {
  std::sort(normals.begin(), normals.end(), [](const glm::vec3& a, const glm::vec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  });
  std::vector<Kernel::Point_3> points;
  for (const glm::vec3& n : normals) points.emplace_back(n.x, n.y, n.z);
  Ball ball(points.begin(), points.end());
  const auto at = ball.center_cartesian_begin();
  const glm::dvec3 center(at[0], at[1], at[2]);
  // Near a right angle the ball of doubles may leave out some of the points.
  const bool is_middle = std::all_of(normals.begin(), normals.end(), [&](const glm::vec3& n) {
    return glm::dot(center, glm::dvec3(n)) > shortest_center * shortest_center;
  });
  return is_middle && glm::length(center) > shortest_center ? glm::vec3(glm::normalize(center))
                                                            : glm::vec3(0);
}

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
  std::vector<glm::vec3> around;
  for (std::size_t i = 0; i < faces.size();) {
    const std::uint32_t g = faces[i].first;
    around.clear();
    for (; i < faces.size() && faces[i].first == g; ++i)
      if (const glm::vec3& n = normals[faces[i].second]; n != glm::vec3(0)) around.push_back(n);
    has_face[g] = 1;
    if (!around.empty()) group_normals[g] = middle_of(around);
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
