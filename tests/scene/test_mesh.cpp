#include "lambake/scene/mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "lambake/core/error.h"

namespace lambake {
namespace {

Mesh triangle() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

TEST(CheckMesh, ATriangleWithAndWithoutAttributes_IsSound) {
  Mesh mesh = triangle();
  EXPECT_NO_THROW(check_mesh(mesh, 1));
  mesh.normals.resize(3);
  mesh.colors.resize(3);
  mesh.opacities.resize(3);
  mesh.texcoords[0].resize(3);
  mesh.texcoords[1].resize(3);
  mesh.source_vertices.resize(3);
  mesh.normal_groups.resize(3);
  mesh.materials.resize(1);
  mesh.source_faces.resize(1);
  mesh.cut_roundings = {{1, 0.5}};
  EXPECT_NO_THROW(check_mesh(mesh, 1));
  EXPECT_NO_THROW(check_mesh({}, 1));
}

TEST(CheckMesh, AnArrayOfAnotherLength_IsRefusedByName) {
  const std::vector<std::pair<std::string, std::function<void(Mesh&)>>> broken = {
      {"normals", [](Mesh& m) { m.normals.resize(2); }},
      {"colors", [](Mesh& m) { m.colors.resize(4); }},
      {"opacities", [](Mesh& m) { m.opacities.resize(1); }},
      {"texcoords[0]", [](Mesh& m) { m.texcoords[0].resize(2); }},
      {"texcoords[1]", [](Mesh& m) { m.texcoords[1].resize(2); }},
      {"source_vertices", [](Mesh& m) { m.source_vertices.resize(2); }},
      {"normal_groups", [](Mesh& m) { m.normal_groups.resize(2); }},
      {"materials", [](Mesh& m) { m.materials.resize(2); }},
      {"source_faces", [](Mesh& m) { m.source_faces.resize(2); }}};
  for (const auto& [name, spoil] : broken) {
    Mesh mesh = triangle();
    spoil(mesh);
    try {
      check_mesh(mesh, 1);
      ADD_FAILURE() << name;
    } catch (const InvalidScene& error) {
      EXPECT_NE(std::string(error.what()).find(name + ": expected"), std::string::npos) << error.what();
    }
  }
}

TEST(CheckMesh, CutRoundings_AreOfAllTrianglesInOrder) {
  Mesh mesh = triangle();
  mesh.triangles.resize(3, mesh.triangles[0]);
  mesh.cut_roundings = {{1, 0}, {3, 1e-7}};
  EXPECT_NO_THROW(check_mesh(mesh, 1));
  EXPECT_EQ(mesh.cut_rounding_of(0), 0);
  EXPECT_EQ(mesh.cut_rounding_of(1), 1e-7);
  EXPECT_EQ(mesh.cut_rounding_of(2), 1e-7);
  const std::vector<std::vector<CutRounding>> broken = {
      {{2, 0}}, {{4, 0}}, {{2, 0}, {2, 0}, {3, 0}}, {{3, -1}}, {{3, std::nan("")}}};
  for (const std::vector<CutRounding>& roundings : broken) {
    mesh.cut_roundings = roundings;
    EXPECT_THROW(check_mesh(mesh, 1), InvalidScene);
  }
}

TEST(CheckMesh, AnIndexOutOfRange_IsRefused) {
  Mesh mesh = triangle();
  mesh.triangles.emplace_back(0, 1, 3);
  EXPECT_THROW(check_mesh(mesh, 1), InvalidScene);
  mesh = triangle();
  mesh.materials = {1};
  EXPECT_NO_THROW(check_mesh(mesh, 2));
  EXPECT_THROW(check_mesh(mesh, 1), InvalidScene);
  EXPECT_THROW(check_mesh(triangle(), 0), InvalidScene);
}

TEST(AppendVertexCopy, CopiesEveryAttributeThatThereIs_AndNamesTheSource) {
  Mesh mesh = triangle();
  mesh.normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.opacities = {0.1f, 0.2f, 0.3f};
  mesh.texcoords[1] = {{0, 0}, {1, 1}, {2, 2}};
  mesh.normal_groups = {4, 5, 6};
  EXPECT_EQ(append_vertex_copy(mesh, 1), 3U);
  EXPECT_EQ(append_vertex_copy(mesh, 3), 4U);
  EXPECT_NO_THROW(check_mesh(mesh, 1));
  EXPECT_EQ(mesh.positions[4], mesh.positions[1]);
  EXPECT_EQ(mesh.normals[4], mesh.normals[1]);
  EXPECT_EQ(mesh.colors[4], mesh.colors[1]);
  EXPECT_EQ(mesh.opacities[4], 0.2f);
  EXPECT_EQ(mesh.texcoords[1][4], glm::vec2(1));
  EXPECT_TRUE(mesh.texcoords[0].empty());
  EXPECT_EQ(mesh.normal_groups[4], 5U);
  EXPECT_EQ(mesh.source_vertices, (std::vector<std::uint32_t>{0, 1, 2, 1, 1}));
}

}  // namespace
}  // namespace lambake
