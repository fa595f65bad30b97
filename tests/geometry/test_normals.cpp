#include "lambake/geometry/normals.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "lambake/core/parallel.h"
#include "shapes.h"

namespace lambake {
namespace {

constexpr std::array every_weight = {NormalWeight::angle, NormalWeight::area, NormalWeight::uniform,
                                     NormalWeight::max};

double angle_deg(const glm::vec3& a, const glm::vec3& b) {
  const glm::dvec3 u(a), v(b);
  return std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v)) * 180 / std::numbers::pi;
}

/// Largest angle between the normals and the directions of the vertices from the centre of a sphere, cube, …
double worst_angle_to_radius_deg(const Mesh& mesh, NormalWeight weight) {
  const VertexNormals result = vertex_normals(mesh, weight);
  EXPECT_EQ(result.undefined, 0U);
  double worst = 0;
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v)
    worst = std::max(worst, angle_deg(result.normals[v], mesh.positions[v]));
  return worst;
}

/// How many triangles of each side (x, y, z) of the cube meet at vertex `v`.
std::array<int, 3> triangles_by_side(const Mesh& mesh, std::uint32_t v) {
  const std::vector<glm::vec3> normals = face_normals(mesh);
  std::array<int, 3> counts{};
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f)
    for (int c = 0; c < 3; ++c)
      if (mesh.triangles[f][c] == v)
        for (int axis = 0; axis < 3; ++axis)
          counts[static_cast<std::size_t>(axis)] += std::abs(normals[f][axis]) > 0.5f;
  return counts;
}

TEST(VertexNormals, OneTriangle_AnyWeight_PointsAlongItsNormal) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  mesh.triangles = {{0, 1, 2}};
  for (const NormalWeight weight : every_weight)
    for (const glm::vec3& n : vertex_normals(mesh, weight).normals) EXPECT_EQ(n, glm::vec3(0, 0, 1));
}

TEST(VertexNormals, AngleWeight_AnySplitOfACube_PointsAlongTheDiagonal) {
  // A float normal is within half an ulp of 1 per coordinate: 1e-5 degrees.
  for (unsigned split = 0; split < 64; ++split)
    EXPECT_LT(worst_angle_to_radius_deg(cube(split), NormalWeight::angle), 1e-5) << split;
}

TEST(VertexNormals, UniformAndAreaWeights_SplitsOfACube_LeanTowardsTheSidesOfTwoTriangles) {
  // With n_x, n_y, n_z triangles of equal area on the three sides the mean is (n_x, n_y, n_z): 0, 15.79 or
  // 19.47 degrees off the diagonal.
  std::set<int> hundredths_seen;
  for (unsigned split = 0; split < 64; ++split) {
    const Mesh mesh = cube(split);
    for (const NormalWeight weight : {NormalWeight::uniform, NormalWeight::area}) {
      const VertexNormals result = vertex_normals(mesh, weight);
      for (std::uint32_t v = 0; v < 8; ++v) {
        const auto [nx, ny, nz] = triangles_by_side(mesh, v);
        const double expected = angle_deg(glm::vec3(nx, ny, nz), glm::vec3(1));
        EXPECT_NEAR(angle_deg(result.normals[v], mesh.positions[v]), expected, 1e-5);
        hundredths_seen.insert(static_cast<int>(std::lround(100 * expected)));
      }
    }
  }
  EXPECT_EQ(hundredths_seen, (std::set<int>{0, 1579, 1947}));
}

TEST(VertexNormals, AngleWeight_UvSpheres_ErrorFallsAsTheSquareOfTheRings) {
  // Known to the digits given; the last one may be rounded either way.
  EXPECT_NEAR(worst_angle_to_radius_deg(uv_sphere(8, 16), NormalWeight::angle), 1.27, 0.005);
  EXPECT_NEAR(worst_angle_to_radius_deg(uv_sphere(16, 32), NormalWeight::angle), 0.34, 0.005);
  EXPECT_NEAR(worst_angle_to_radius_deg(uv_sphere(32, 64), NormalWeight::angle), 0.087, 0.0005);
}

TEST(VertexNormals, MaxWeight_MeshesInscribedInASphere_IsExact) {
  // Positions are rounded to float, and triangles at the poles are 0.1 wide: 1e-4 degrees.
  for (const unsigned rings : {8U, 16U, 32U})
    EXPECT_LT(worst_angle_to_radius_deg(uv_sphere(rings, 2 * rings), NormalWeight::max), 1e-4) << rings;
  EXPECT_LT(worst_angle_to_radius_deg(icosphere(3), NormalWeight::max), 1e-4);
  // The other weights are not: the test above this one cannot pass by chance.
  EXPECT_GT(worst_angle_to_radius_deg(icosphere(3), NormalWeight::uniform), 0.1);
}

TEST(VertexNormals, ARightAngledFold_IsWeightedAsItsNameSays) {
  // At vertex 0 a triangle facing z (legs 3 and 1) meets one facing x (legs 3 and 2), both at right angles.
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 3, 0}, {0, 0, 2}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  const auto at_fold = [&](NormalWeight weight) { return vertex_normals(mesh, weight).normals[0]; };
  EXPECT_LT(angle_deg(at_fold(NormalWeight::angle), {1, 0, 1}), 1e-5);
  EXPECT_LT(angle_deg(at_fold(NormalWeight::uniform), {1, 0, 1}), 1e-5);
  EXPECT_LT(angle_deg(at_fold(NormalWeight::area), {2, 0, 1}), 1e-5);
  EXPECT_LT(angle_deg(at_fold(NormalWeight::max), {1 / 6.0f, 0, 1 / 3.0f}), 1e-5);
}

TEST(VertexNormals, ReversedWinding_NegatesTheNormals) {
  const Mesh mesh = height_field(8);
  Mesh reversed = mesh;
  for (glm::uvec3& t : reversed.triangles) std::swap(t.y, t.z);
  for (const NormalWeight weight : every_weight) {
    const std::vector<glm::vec3> a = vertex_normals(mesh, weight).normals;
    const std::vector<glm::vec3> b = vertex_normals(reversed, weight).normals;
    for (std::size_t v = 0; v < a.size(); ++v) EXPECT_EQ(a[v], -b[v]);
  }
}

TEST(VertexNormals, ScaledByAPowerOfTwo_SameBits) {
  const Mesh mesh = height_field(8);
  for (const int exponent : {-40, 40}) {
    Mesh scaled = mesh;
    for (glm::vec3& p : scaled.positions)
      p = glm::vec3(std::ldexp(p.x, exponent), std::ldexp(p.y, exponent), std::ldexp(p.z, exponent));
    for (const NormalWeight weight : every_weight)
      EXPECT_EQ(vertex_normals(scaled, weight).normals, vertex_normals(mesh, weight).normals);
  }
}

TEST(VertexNormals, TwoFacesBackToBack_HaveNoDirection_AndAreCounted) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}, {6, 5, 5}, {5, 6, 5}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 1}, {3, 4, 5}};
  for (const NormalWeight weight : every_weight) {
    const VertexNormals result = vertex_normals(mesh, weight);
    EXPECT_EQ(result.undefined, 3U);
    EXPECT_EQ(result.normals[0], glm::vec3(0));
    EXPECT_EQ(result.normals[3], glm::vec3(0, 0, 1));
  }
}

TEST(VertexNormals, MoebiusBand_EveryNormalIsUnitOrCounted) {
  const Mesh mesh = moebius_band(48);
  for (const NormalWeight weight : every_weight) {
    const VertexNormals result = vertex_normals(mesh, weight);
    std::size_t n_without = 0;
    for (const glm::vec3& n : result.normals) {
      const bool is_without = n == glm::vec3(0);
      n_without += is_without;
      EXPECT_NEAR(glm::length(n), is_without ? 0 : 1, 1e-6);
    }
    EXPECT_EQ(result.undefined, n_without);
  }
}

TEST(VertexNormals, FacesWithoutADirection_AddNothing) {
  const Mesh sound = cube(0);
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  Mesh dirty = sound;
  dirty.positions.insert(dirty.positions.end(), {{nan, 0, 0}, {0, inf, 0}, {0, -1, -1}});
  dirty.triangles.insert(dirty.triangles.end(), {{0, 0, 1},    // repeats a vertex
                                                 {0, 10, 1},   // on a line: vertex 10 is between 0 and 1
                                                 {0, 1, 8},    // not a number
                                                 {2, 3, 9}});  // infinite
  for (const NormalWeight weight : every_weight) {
    const VertexNormals expected = vertex_normals(sound, weight), found = vertex_normals(dirty, weight);
    for (std::size_t v = 0; v < 8; ++v) EXPECT_EQ(found.normals[v], expected.normals[v]);
    EXPECT_EQ(found.undefined, 3U);
  }
}

TEST(VertexNormals, IsolatedVertex_HasNoDirection_AndIsNotCountedAsUndefined) {
  Mesh mesh = cube(0);
  mesh.positions.emplace_back(9, 9, 9);
  const VertexNormals result = vertex_normals(mesh, NormalWeight::angle);
  EXPECT_EQ(result.normals.back(), glm::vec3(0));
  EXPECT_EQ(result.undefined, 0U);
}

TEST(VertexNormals, EmptyMesh_HasNone) {
  EXPECT_TRUE(vertex_normals({}, NormalWeight::angle).normals.empty());
  EXPECT_TRUE(face_normals({}).empty());
}

TEST(VertexNormals, CopiesOfOneVertexOfTheFile_ShareItsNormal_GroupsDoNot) {
  // Side by side, with a seam between them: vertices 4 and 5 are copies of 1 and 2.
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {2, 0, 1}, {1, 0, 0}, {1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {4, 3, 5}};
  mesh.source_vertices = {0, 1, 2, 3, 1, 2};
  const VertexNormals seam = vertex_normals(mesh, NormalWeight::angle);
  EXPECT_EQ(seam.normals[1], seam.normals[4]);
  EXPECT_EQ(seam.normals[2], seam.normals[5]);
  EXPECT_NE(seam.normals[1], seam.normals[0]);
  mesh.normal_groups = {0, 0, 0, 1, 1, 1};
  const VertexNormals crease = vertex_normals(mesh, NormalWeight::angle);
  EXPECT_EQ(crease.normals[1], glm::vec3(0, 0, 1));
  EXPECT_EQ(crease.normals[4], crease.normals[3]);
}

TEST(VertexNormals, OneOrTwoThreads_SameBits) {
  const Mesh mesh = icosphere(6);  // Several blocks of vertices.
  set_thread_count(1);
  const std::vector<glm::vec3> one = vertex_normals(mesh, NormalWeight::angle).normals;
  set_thread_count(2);
  const std::vector<glm::vec3> two = vertex_normals(mesh, NormalWeight::angle).normals;
  set_thread_count(0);
  EXPECT_EQ(one, two);
}

TEST(FaceNormals, SliversDownToAnAspectOfTenMillion_KeepTheirDirection) {
  for (const float height : {1e-3f, 1e-5f, 1e-7f}) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0.5f, 0, height}};
    mesh.triangles = {{0, 1, 2}};
    EXPECT_EQ(face_normals(mesh).front(), glm::vec3(0, -1, 0)) << height;
  }
}

}  // namespace
}  // namespace lambake
