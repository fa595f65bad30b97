#include "lambake/geometry/robust_normals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include <algorithm>
#include <cmath>

#include "shapes.h"

namespace lambake {
namespace {

TEST(RobustNormals, AnySplitOfACube_PointsAlongTheDiagonal) {
  for (unsigned split = 0; split < 64; ++split) {
    const Mesh mesh = cube(split);
    const VertexNormals made = robust_normals(mesh);
    EXPECT_EQ(made.undefined, 0U);
    for (std::size_t v = 0; v < mesh.n_vertices(); ++v)
      EXPECT_LT(glm::length(made.normals[v] - glm::normalize(mesh.positions[v])), 1e-6f) << "split " << split;
  }
}

// No other direction has a larger smallest cosine to the faces around: not the weighted means either.
TEST(RobustNormals, Hills_SeeTheirWorstFaceBest) {
  const Mesh mesh = height_field(6);
  const std::vector<glm::vec3> faces = face_normals(mesh);
  const auto worst_cosines = [&](const std::vector<glm::vec3>& normals) {
    std::vector<float> worst(mesh.n_vertices(), 1);
    for (std::size_t f = 0; f < mesh.n_triangles(); ++f)
      for (int c = 0; c < 3; ++c) {
        const std::uint32_t v = mesh.triangles[f][c];
        worst[v] = std::min(worst[v], glm::dot(normals[v], faces[f]));
      }
    return worst;
  };
  const std::vector<float> robust = worst_cosines(robust_normals(mesh).normals);
  for (const NormalWeight weight : {NormalWeight::angle, NormalWeight::area, NormalWeight::uniform}) {
    const std::vector<float> mean = worst_cosines(vertex_normals(mesh, weight).normals);
    bool is_better_somewhere = false;
    for (std::size_t v = 0; v < robust.size(); ++v) {
      EXPECT_GE(robust[v], mean[v] - 1e-6f);
      is_better_somewhere |= robust[v] > mean[v] + 1e-3f;
    }
    EXPECT_TRUE(is_better_somewhere);
  }
}

TEST(RobustNormals, NormalsAllAround_LieWithinARightAngleOfEachFace_InAnyOrderOfFaces) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> anywhere(-1, 1);
  std::size_t n_undefined = 0;
  for (int fan = 0; fan < 2000; ++fan) {  // Some fit into half a space, some do not.
    Mesh mesh;
    mesh.positions = {{0, 0, 0}};
    for (std::uint32_t i = 0; i < 9; ++i)
      mesh.positions.emplace_back(anywhere(random), anywhere(random), 3 * anywhere(random));
    for (std::uint32_t i = 1; i < 9; ++i) mesh.triangles.push_back({0, i, i + 1});
    const VertexNormals made = robust_normals(mesh);
    const glm::dvec3 n(made.normals[0]);
    n_undefined += n == glm::dvec3(0);
    for (const glm::vec3& face : face_normals(mesh)) EXPECT_GE(glm::dot(n, glm::dvec3(face)), -1e-6) << fan;
    std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
    EXPECT_EQ(robust_normals(mesh).normals[0], made.normals[0]) << fan;
  }
  EXPECT_GT(n_undefined, 100U);
  EXPECT_LT(n_undefined, 1900U);
}

TEST(RobustNormals, FacesBackToBackAndDefects_HaveNoDirectionAndAreCounted) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {7, 7, 7}, {NAN, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 1}, {0, 0, 1}, {0, 1, 4}};
  const VertexNormals made = robust_normals(mesh);
  EXPECT_EQ(made.undefined, 4U);
  for (const glm::vec3& n : made.normals) EXPECT_EQ(n, glm::vec3(0));
  EXPECT_TRUE(robust_normals(Mesh{}).normals.empty());
}

}  // namespace
}  // namespace lambake
