#include "shapes.h"

#include <gtest/gtest.h>

#include <numbers>
#include <ostream>
#include <string>

#include "lambake/geometry/defects.h"
#include "lambake/geometry/normals.h"

namespace lambake {
namespace {

/// Volume enclosed by a closed mesh; positive where triangles wind counter-clockwise seen from outside.
double enclosed_volume(const Mesh& mesh) {
  double six_volumes = 0;
  for (const glm::uvec3& t : mesh.triangles)
    six_volumes += glm::dot(glm::dvec3(mesh.positions[t.x]),
                            glm::cross(glm::dvec3(mesh.positions[t.y]), glm::dvec3(mesh.positions[t.z])));
  return six_volumes / 6;
}

struct ClosedShape {
  std::string name;
  Mesh mesh;
  std::size_t n_vertices, n_triangles;
  double volume, tolerance;
  friend void PrintTo(const ClosedShape& shape, std::ostream* out) { *out << shape.name; }
};

class ClosedShapes : public testing::TestWithParam<ClosedShape> {};

TEST_P(ClosedShapes, HaveTheirCountsAndVolume_FaceOutwards_HaveNoDefect) {
  const ClosedShape& shape = GetParam();
  EXPECT_NO_THROW(check_mesh(shape.mesh, 1));
  EXPECT_EQ(shape.mesh.n_vertices(), shape.n_vertices);
  EXPECT_EQ(shape.mesh.n_triangles(), shape.n_triangles);
  EXPECT_NEAR(enclosed_volume(shape.mesh), shape.volume, shape.tolerance);
  const Defects d = find_defects(shape.mesh);
  EXPECT_TRUE(d.is_closed);
  EXPECT_TRUE(d.is_consistently_wound);
  EXPECT_EQ(d.components, 1U);
  EXPECT_EQ(d.isolated_vertices + d.zero_area_faces + d.repeated_vertex_faces + d.duplicate_faces +
                d.duplicate_positions + d.non_manifold_edges,
            0U);
}

constexpr double sphere_volume = 4 * std::numbers::pi / 3;
/// π r² times the length of the knot, 15.3371 (its integral; exact for a tube thinner than the bends).
constexpr double knot_volume = std::numbers::pi * 0.2 * 0.2 * 15.3371;
/// 2.4 × 1.6 less what rounding takes from the corners, times the height of 1.4.
constexpr double rounded_box_volume = (2.4 * 1.6 - (4 - std::numbers::pi) * 0.09) * 1.4;

// An inscribed polyhedron falls short of the curved volume by its share of h².
INSTANTIATE_TEST_SUITE_P(
    Shapes, ClosedShapes,
    testing::Values(ClosedShape{"icosahedron", icosphere(0), 12, 20, 2.53615, 1e-5},
                    ClosedShape{"icosphere", icosphere(4), 2562, 5120, sphere_volume, 0.02},
                    ClosedShape{"uv_sphere", uv_sphere(32, 64), 1986, 3968, sphere_volume, 0.03},
                    ClosedShape{"torus_knot", torus_knot(480, 48, 0.2f), 23040, 46080, knot_volume, 0.01},
                    ClosedShape{"cube", cube(0), 8, 12, 8, 0},
                    ClosedShape{"rounded_box", rounded_box(16), 138, 272, rounded_box_volume, 1e-3}),
    [](const auto& test) { return test.param.name; });

TEST(Cube, EverySplit_IsAClosedCubeOfItsOwn) {
  for (unsigned split = 0; split < 64; ++split) {
    const Mesh mesh = cube(split);
    EXPECT_EQ(enclosed_volume(mesh), 8) << split;
    EXPECT_TRUE(find_defects(mesh).is_closed) << split;
    EXPECT_TRUE(find_defects(mesh).is_consistently_wound) << split;
    for (unsigned other = 0; other < split; ++other) EXPECT_NE(mesh.triangles, cube(other).triangles);
  }
}

TEST(Icosphere, Levels_KeepTheVerticesOfTheLevelBefore) {
  const Mesh coarse = icosphere(2), fine = icosphere(3);
  for (std::size_t v = 0; v < coarse.n_vertices(); ++v) EXPECT_EQ(coarse.positions[v], fine.positions[v]);
}

TEST(TorusKnot, ExactNormals_AgreeWithThoseOfTheFaces) {
  const Mesh mesh = torus_knot(480, 48, 0.2f);
  const VertexNormals estimated = vertex_normals(mesh, NormalWeight::angle);
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v) {
    EXPECT_NEAR(glm::length(mesh.normals[v]), 1, 1e-6);
    // Faces are 3.75° of a turn wide: a swapped or tilted frame would be off by far more.
    EXPECT_GT(glm::dot(mesh.normals[v], estimated.normals[v]), 0.999);
  }
}

TEST(Grid, FacesUp_WithItsArea) {
  for (const unsigned n : {1U, 5U}) {
    const Mesh mesh = grid(n, 1.5f);
    EXPECT_EQ(mesh.n_vertices(), (n + 1) * (n + 1));
    EXPECT_EQ(mesh.n_triangles(), 2 * n * n);
    double area = 0;
    for (const glm::uvec3& t : mesh.triangles)
      area += 0.5 * double(glm::cross(mesh.positions[t.y] - mesh.positions[t.x],
                                      mesh.positions[t.z] - mesh.positions[t.x])
                               .y);
    EXPECT_NEAR(area, 9, 1e-5);
  }
}

TEST(HeightField, IsGentle_AndFacesUp) {
  for (const glm::vec3& n : face_normals(height_field(64))) EXPECT_GT(n.y, 0.5f);
}

TEST(MoebiusBand, HasOneRimAndOneConflictingEdge) {
  const Mesh mesh = moebius_band(48);
  const Defects d = find_defects(mesh);
  EXPECT_EQ(mesh.n_triangles(), 96U);
  EXPECT_EQ(d.border_edges, 96U);
  EXPECT_EQ(d.conflicting_edges, 1U);
  EXPECT_EQ(d.components, 1U);
}

}  // namespace
}  // namespace lambake
