#include "lambake/geometry/normals.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

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
  return glm::dot(cross, cross) > 1e-24 * (longest * longest) ? cross : glm::dvec3(0);
}

/// atan2(y, x) for y > 0, to 2e-9 and a fraction of its time: Chebyshev interpolation of atan(z)/z over z² in
/// [0,1]. An error of 2e-9 in a weight is far below what a float normal holds.
double angle_of(double y, double x) {
  constexpr double c[] = {0.999999997161,  -0.33333276292,   0.199980752808, -0.142600160797,
                          0.109323414859,  -0.083497249245,  0.057089555187, -0.0303518640434,
                          0.0104876488531, -0.00170116997324};
  const double size_x = std::abs(x);
  const double z = std::min(y, size_x) / std::max(y, size_x), u = z * z;
  double sum = 0;
  for (int i = 9; i >= 0; --i) sum = sum * u + c[i];
  const double low = z * sum;
  const double first_quadrant = y > size_x ? std::numbers::pi / 2 - low : low;
  return x < 0 ? std::numbers::pi - first_quadrant : first_quadrant;
}

/// What a triangle adds at its corners: its unit normal, weighted.
struct FaceShare {
  glm::dvec3 normal{0};
  double weights[3] = {0, 0, 0};
};

double corner_weight(double doubled_area, const glm::dvec3& e1, const glm::dvec3& e2, NormalWeight weight) {
  switch (weight) {
    case NormalWeight::angle:
      return angle_of(doubled_area, glm::dot(e1, e2));
    case NormalWeight::area:
      return doubled_area;
    case NormalWeight::uniform:
      return 1;
    case NormalWeight::max:
      return doubled_area / (glm::dot(e1, e1) * glm::dot(e2, e2));
  }
  return 0;
}

FaceShare face_share(const Mesh& mesh, const glm::uvec3& t, NormalWeight weight) {
  const glm::dvec3 cross = area_vector(mesh, t);
  const double length = glm::length(cross);
  if (!(length > 0)) return {};
  const glm::dvec3 p0(mesh.positions[t[0]]), p1(mesh.positions[t[1]]), p2(mesh.positions[t[2]]);
  return {cross / length,
          {corner_weight(length, p1 - p0, p2 - p0, weight), corner_weight(length, p2 - p1, p0 - p1, weight),
           corner_weight(length, p0 - p2, p1 - p2, weight)}};
}

struct NormalSum {
  glm::dvec3 normal{0};
  double weights = 0;
};

}  // namespace

VertexNormals vertex_normals(const Mesh& mesh, NormalWeight weight) {
  const std::vector<std::uint32_t>& group_of =
      mesh.normal_groups.empty() ? mesh.source_vertices : mesh.normal_groups;
  std::size_t n_groups = mesh.n_vertices();
  for (const std::uint32_t g : group_of) n_groups = std::max<std::size_t>(n_groups, g + 1);
  const auto group = [&](std::uint32_t v) { return group_of.empty() ? v : group_of[v]; };

  // The arithmetic in parallel, a batch of faces at a time; the sums in the order of the faces.
  constexpr std::size_t batch_size = 32768;
  std::vector<NormalSum> sums(n_groups);
  std::vector<bool> is_used(n_groups, false);
  std::vector<FaceShare> shares(std::min(batch_size, mesh.n_triangles()));
  for (std::size_t first = 0; first < mesh.n_triangles(); first += batch_size) {
    const std::size_t n = std::min(batch_size, mesh.n_triangles() - first);
    parallel_blocks(n, block_size, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        shares[i] = face_share(mesh, mesh.triangles[first + i], weight);
    });
    for (std::size_t i = 0; i < n; ++i)
      for (int c = 0; c < 3; ++c) {
        const std::uint32_t g = group(mesh.triangles[first + i][c]);
        sums[g].normal += shares[i].normal * shares[i].weights[c];
        sums[g].weights += shares[i].weights[c];
        is_used[g] = true;
      }
  }

  VertexNormals result;
  result.normals.resize(mesh.n_vertices());
  parallel_blocks(mesh.n_vertices(), block_size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const NormalSum& sum = sums[group(static_cast<std::uint32_t>(v))];
      const double length = glm::length(sum.normal);
      if (length > cancelled * sum.weights) result.normals[v] = glm::vec3(sum.normal / length);
    }
  });
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v)
    result.undefined += is_used[group(static_cast<std::uint32_t>(v))] && result.normals[v] == glm::vec3(0);
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
