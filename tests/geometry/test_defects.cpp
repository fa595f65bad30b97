#include "lambake/geometry/defects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "lambake/geometry/creases.h"
#include "shapes.h"

namespace lambake {
namespace {

TEST(Defects, SoundClosedMesh_HasNone) {
  const Defects d = find_defects(cube(0));
  EXPECT_EQ(d.non_finite_vertices + d.isolated_vertices + d.repeated_vertex_faces + d.zero_area_faces +
                d.duplicate_faces + d.border_edges + d.non_manifold_edges + d.conflicting_edges +
                d.duplicate_positions,
            0U);
  EXPECT_EQ(d.components, 1U);
  EXPECT_TRUE(d.is_closed);
  EXPECT_TRUE(d.is_consistently_wound);
}

TEST(Defects, EmptyMesh_IsNotClosed) {
  const Defects d = find_defects({});
  EXPECT_FALSE(d.is_closed);
  EXPECT_EQ(d.components, 0U);
}

TEST(Defects, OpenSheet_CountsItsRim) {
  const Defects d = find_defects(grid(5, 1));
  EXPECT_EQ(d.border_edges, 20U);
  EXPECT_FALSE(d.is_closed);
  EXPECT_TRUE(d.is_consistently_wound);
}

TEST(Defects, OneFaceTurnedOver_ConflictsAtItsThreeEdges) {
  Mesh mesh = cube(0);
  std::swap(mesh.triangles[3].x, mesh.triangles[3].y);
  const Defects d = find_defects(mesh);
  EXPECT_EQ(d.conflicting_edges, 3U);
  EXPECT_FALSE(d.is_consistently_wound);
  EXPECT_TRUE(d.is_closed);
}

TEST(Defects, AFin_MakesOneNonManifoldEdge) {
  Mesh mesh = cube(0);
  mesh.positions.emplace_back(-3, -3, 0);
  mesh.triangles.emplace_back(0, 4, 8);
  const Defects d = find_defects(mesh);
  EXPECT_EQ(d.non_manifold_edges, 1U);
  EXPECT_EQ(d.border_edges, 2U);
}

TEST(Defects, FacesThatRepeatAVertexOrHaveNoArea_AreCountedApart) {
  Mesh mesh = cube(0);
  mesh.positions.insert(mesh.positions.end(), {{2, 0, 0}, {3, 0, 0}, {4, 0, 0}});
  mesh.triangles.insert(mesh.triangles.end(), {{8, 9, 10}, {8, 8, 9}, {9, 9, 9}});
  const Defects d = find_defects(mesh);
  EXPECT_EQ(d.zero_area_faces, 1U);
  EXPECT_EQ(d.repeated_vertex_faces, 2U);
  EXPECT_EQ(d.duplicate_faces, 0U);
  EXPECT_EQ(d.components, 2U);
}

TEST(Defects, RepeatedFaces_AreCounted_WhicheverWayTheyWind) {
  Mesh mesh = cube(0);
  const glm::uvec3 t = mesh.triangles[0];
  mesh.triangles.insert(mesh.triangles.end(), {{t.y, t.z, t.x}, {t.z, t.y, t.x}});
  EXPECT_EQ(find_defects(mesh).duplicate_faces, 2U);
}

TEST(Defects, VerticesThatAreNotFinite_AreCounted_AndAreNoCopiesOfEachOther) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Mesh mesh = cube(0);
  mesh.positions[0].y = nan;
  mesh.positions.insert(mesh.positions.end(), {{nan, 0, 0}, {nan, 0, 0}});
  const Defects d = find_defects(mesh);
  EXPECT_EQ(d.non_finite_vertices, 3U);
  EXPECT_EQ(d.isolated_vertices, 2U);
  EXPECT_EQ(d.duplicate_positions, 0U);
}

TEST(Defects, EqualPositions_AreCounted_MinusZeroToo) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0f, 0, -0.0f}, {1, 0, 0}, {1, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 2}};
  const Defects d = find_defects(mesh);
  EXPECT_EQ(d.duplicate_positions, 3U);
  EXPECT_EQ(d.isolated_vertices, 1U);
}

TEST(Defects, CopiesMadeAtCreases_DoNotOpenTheMesh) {
  Mesh mesh = cube(0);
  ASSERT_EQ(split_creases(mesh, 0.5f), 16U);
  const Defects d = find_defects(mesh);
  EXPECT_TRUE(d.is_closed);
  EXPECT_EQ(d.components, 1U);
  EXPECT_EQ(d.isolated_vertices + d.duplicate_positions, 0U);
}

TEST(Defects, RandomFaces_AreCountedAsOneByOne) {
  std::mt19937 engine(5);
  for (const std::uint32_t n_vertices : {3U, 5U, 12U, 200U})
    for (int round = 0; round < 20; ++round) {
      // On a grid, so that some triangles have no area.
      Mesh mesh;
      for (std::uint32_t v = 0; v < n_vertices; ++v)
        mesh.positions.emplace_back(engine() % 4, engine() % 4, engine() % 2);
      for (int f = 0; f < 300; ++f)
        mesh.triangles.emplace_back(engine() % n_vertices, engine() % n_vertices, engine() % n_vertices);

      std::map<std::pair<std::uint32_t, std::uint32_t>, std::array<std::size_t, 2>> edges;
      std::map<std::set<std::uint32_t>, std::size_t> faces;
      Defects expected;
      for (const glm::uvec3& t : mesh.triangles) {
        const std::set<std::uint32_t> named{t.x, t.y, t.z};
        expected.repeated_vertex_faces += named.size() < 3;
        if (named.size() < 3) continue;
        ++faces[named];
        for (int c = 0; c < 3; ++c) {
          const std::uint32_t from = t[c], to = t[(c + 1) % 3];
          ++edges[{std::min(from, to), std::max(from, to)}][from > to];
        }
        const glm::dvec3 p0(mesh.positions[t.x]), p1(mesh.positions[t.y]), p2(mesh.positions[t.z]);
        expected.zero_area_faces += glm::cross(p1 - p0, p2 - p0) == glm::dvec3(0);
      }
      for (const auto& [face, n] : faces) expected.duplicate_faces += n - 1;
      for (const auto& [edge, n] : edges) {
        expected.border_edges += n[0] + n[1] == 1;
        expected.non_manifold_edges += n[0] + n[1] > 2;
        expected.conflicting_edges += n[0] > 1 || n[1] > 1;
      }
      const Defects found = find_defects(mesh);
      EXPECT_EQ(found.repeated_vertex_faces, expected.repeated_vertex_faces);
      EXPECT_EQ(found.zero_area_faces, expected.zero_area_faces);
      EXPECT_EQ(found.duplicate_faces, expected.duplicate_faces);
      EXPECT_EQ(found.border_edges, expected.border_edges);
      EXPECT_EQ(found.non_manifold_edges, expected.non_manifold_edges);
      EXPECT_EQ(found.conflicting_edges, expected.conflicting_edges);
    }
}

TEST(Defects, SliversAmongSoundFaces_AreWithoutAreaOnlyBelowATrillionth) {
  for (const float scale : {1.0f, 1e-15f, 1e15f})
    for (const float height : {1e-3f, 1e-7f, 1e-11f, 1e-13f, 0.0f}) {
      Mesh mesh = height_field(40);
      const auto n = static_cast<std::uint32_t>(mesh.n_vertices());
      mesh.positions.insert(mesh.positions.end(), {{0, 0, 0}, {1, 0, 0}, {0.5f, 0, height}});
      mesh.triangles.insert(mesh.triangles.begin() + 777, {n, n + 1, n + 2});
      for (glm::vec3& p : mesh.positions) p *= scale;
      EXPECT_EQ(find_defects(mesh).zero_area_faces, height < 1e-12f ? 1U : 0U) << height << " " << scale;
    }
}

TEST(Defects, PartsThatShareNoVertex_AreComponents) {
  Mesh mesh = cube(0);
  const Mesh other = cube(1);
  for (const glm::vec3& p : other.positions) mesh.positions.push_back(p + glm::vec3(5, 0, 0));
  for (const glm::uvec3& t : other.triangles) mesh.triangles.push_back(t + glm::uvec3(8));
  EXPECT_EQ(find_defects(mesh).components, 2U);
}

}  // namespace
}  // namespace lambake
