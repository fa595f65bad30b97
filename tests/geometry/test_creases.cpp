#include "lambake/geometry/creases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lambake/geometry/normals.h"
#include "shapes.h"

namespace lambake {
namespace {

constexpr float rad(float degrees) {
  return degrees * std::numbers::pi_v<float> / 180;
}

/// `n` triangles around vertex 0 whose rim rises once around like a screw and falls back in the last one: a
/// crease that ends in the middle of the surface.
Mesh fan_with_a_step(unsigned n) {
  Mesh mesh;
  mesh.positions.emplace_back(0, 0, 0);
  for (unsigned i = 0; i < n; ++i) {
    const double around = 2 * std::numbers::pi * i / n;
    mesh.positions.emplace_back(std::cos(around), double(i) / n, -std::sin(around));
    mesh.triangles.emplace_back(0, 1 + i, 1 + (i + 1) % n);
  }
  return mesh;
}

TEST(Creases, AnySplitOfACube_EachSideGetsItsOwnCorners) {
  for (unsigned split = 0; split < 64; ++split) {
    Mesh mesh = cube(split);
    EXPECT_EQ(split_creases(mesh, rad(30)), 16U);
    EXPECT_EQ(mesh.n_vertices(), 24U);
    const VertexNormals result = vertex_normals(mesh, NormalWeight::angle);
    const std::vector<glm::vec3> faces = face_normals(mesh);
    for (std::size_t f = 0; f < mesh.n_triangles(); ++f)
      for (int c = 0; c < 3; ++c) EXPECT_EQ(result.normals[mesh.triangles[f][c]], faces[f]);
  }
}

TEST(Creases, ACubeIsSharpBelowNinetyDegrees_AndSmoothAbove) {
  Mesh sharp = cube(0), smooth = cube(0);
  EXPECT_EQ(split_creases(sharp, rad(89.9f)), 16U);
  EXPECT_EQ(split_creases(smooth, rad(90.1f)), 0U);
  EXPECT_EQ(smooth.triangles, cube(0).triangles);
  EXPECT_EQ(vertex_normals(smooth, NormalWeight::angle).normals,
            vertex_normals(cube(0), NormalWeight::angle).normals);
}

TEST(Creases, RoundedBox_SplitsItsTwoRims_LidsAreFlatAndWallsUpright) {
  Mesh mesh = rounded_box(8);
  EXPECT_EQ(split_creases(mesh, rad(30)), 72U);
  const VertexNormals result = vertex_normals(mesh, NormalWeight::angle);
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    const bool is_lid = f % 4 >= 2;
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(std::abs(result.normals[mesh.triangles[f][c]].y), is_lid ? 1 : 0, 1e-6);
  }
}

TEST(Creases, SmoothSphere_IsLeftAsItIs) {
  Mesh mesh = icosphere(3);
  const Mesh before = mesh;
  EXPECT_EQ(split_creases(mesh, rad(30)), 0U);
  EXPECT_EQ(mesh.positions, before.positions);
  EXPECT_EQ(mesh.triangles, before.triangles);
}

TEST(Creases, ACreaseThatEndsInsideTheSurface_DoesNotSplitItsEnd) {
  Mesh mesh = fan_with_a_step(32);
  ASSERT_GT(glm::dot(face_normals(mesh)[5], face_normals(mesh)[6]), std::cos(rad(30)));
  ASSERT_LT(glm::dot(face_normals(mesh)[31], face_normals(mesh)[0]), std::cos(rad(30)));
  // The falling face is cut off from both of its neighbours, so its corner at the centre is alone; the other
  // 31 faces hang together around the centre.
  EXPECT_EQ(split_creases(mesh, rad(30)), 3U);
  for (std::size_t f = 0; f < 31; ++f) EXPECT_EQ(mesh.triangles[f].x, 0U);
  EXPECT_NE(mesh.triangles[31].x, 0U);
}

TEST(Creases, EdgesOfThreeFaces_AreSharpForAll) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0.01f}, {0, -1, -0.01f}};
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}, {1, 0, 4}};
  EXPECT_EQ(split_creases(mesh, rad(180)), 4U);
}

TEST(Creases, FacesWithoutADirection_GetNoCopies) {
  Mesh mesh = cube(0);
  mesh.positions.insert(mesh.positions.end(), {{2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {5, 0, 0}});
  mesh.triangles.insert(mesh.triangles.end(), {{0, 0, 7}, {8, 9, 10}, {9, 10, 11}, {10, 9, 9}});
  EXPECT_EQ(split_creases(mesh, rad(30)), 16U);
}

TEST(Creases, Copies_KeepAttributes_AndNameTheirSource) {
  Mesh mesh = cube(0);
  for (std::uint32_t v = 0; v < 8; ++v) {
    mesh.colors.push_back({static_cast<float>(v), 0, 0});
    mesh.opacities.push_back(static_cast<float>(v) / 8);
    mesh.texcoords[0].emplace_back(v, 0);
  }
  mesh.normals.assign(8, glm::vec3(0, 1, 0));
  const Mesh before = mesh;
  split_creases(mesh, rad(30));
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_NO_THROW(check_mesh(mesh, 1));
  for (std::uint32_t v = 0; v < mesh.n_vertices(); ++v) {
    const std::uint32_t source = mesh.source_vertex_of(v);
    ASSERT_LT(source, 8U);
    EXPECT_TRUE(v >= 8 || source == v);
    EXPECT_EQ(mesh.positions[v], before.positions[source]);
    EXPECT_EQ(mesh.colors[v], before.colors[source]);
    EXPECT_EQ(mesh.opacities[v], before.opacities[source]);
    EXPECT_EQ(mesh.texcoords[0][v], before.texcoords[0][source]);
  }
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f)
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(mesh.source_vertex_of(mesh.triangles[f][c]), before.triangles[f][c]);
}

TEST(Creases, ATextureSeamAcrossASmoothEdge_StaysSmooth) {
  Mesh mesh = icosphere(2);
  const std::vector<glm::vec3> whole = vertex_normals(mesh, NormalWeight::angle).normals;
  // Every face of the second half gets vertices of its own, as texture charts have.
  for (std::size_t f = mesh.n_triangles() / 2; f < mesh.n_triangles(); ++f)
    for (int c = 0; c < 3; ++c) mesh.triangles[f][c] = append_vertex_copy(mesh, mesh.triangles[f][c]);
  EXPECT_EQ(split_creases(mesh, rad(30)), 0U);
  const std::vector<glm::vec3> charts = vertex_normals(mesh, NormalWeight::angle).normals;
  for (const glm::uvec3& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) EXPECT_EQ(charts[t[c]], whole[mesh.source_vertices[t[c]]]);
}

std::size_t smoothed_faces(Mesh mesh) {
  mesh.normals = vertex_normals(mesh, NormalWeight::angle).normals;
  return count_smoothed_faces(mesh);
}

TEST(SmoothedFaces, BoxesAreAll_RoundShapesAndSplitOnesAreNone) {
  EXPECT_EQ(smoothed_faces(cube(0)), 12U);
  EXPECT_EQ(smoothed_faces(icosphere(2)), 0U);
  EXPECT_EQ(smoothed_faces({}), 0U);
  Mesh turned = icosphere(2);
  for (const glm::vec3& p : turned.positions) turned.normals.push_back(-p);
  EXPECT_EQ(count_smoothed_faces(turned), 0U);
  Mesh split = cube(0);
  split_creases(split, rad(30));
  EXPECT_EQ(smoothed_faces(split), 0U);
}

// Of many faces some are looked at first; what is told is the number of all.
TEST(SmoothedFaces, ManyBoxesAreAllCounted_AFewBesideASphereAreNot) {
  const auto add = [](Mesh& to, const Mesh& mesh) {
    const auto first = static_cast<std::uint32_t>(to.n_vertices());
    to.positions.insert(to.positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (const glm::uvec3& t : mesh.triangles) to.triangles.push_back(t + first);
  };
  Mesh boxes, sphere = icosphere(6);
  for (int i = 0; i < 5000; ++i) add(boxes, cube(0));
  EXPECT_EQ(smoothed_faces(boxes), 60000U);
  for (int i = 0; i < 500; ++i) add(sphere, cube(0));
  EXPECT_EQ(smoothed_faces(sphere), 0U);
}

}  // namespace
}  // namespace lambake
