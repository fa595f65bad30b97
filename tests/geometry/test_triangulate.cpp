#include "lambake/geometry/triangulate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

namespace lambake {
namespace {

double area(const std::vector<glm::vec3>& p, const glm::uvec3& t) {
  return 0.5 * glm::length(glm::cross(glm::dvec3(p[t.y] - p[t.x]), glm::dvec3(p[t.z] - p[t.x])));
}

double area(const std::vector<glm::vec3>& p, const std::vector<glm::uvec3>& triangles) {
  double sum = 0;
  for (const glm::uvec3& t : triangles) sum += area(p, t);
  return sum;
}

std::vector<std::uint32_t> iota(std::size_t n) {
  std::vector<std::uint32_t> polygon(n);
  std::iota(polygon.begin(), polygon.end(), 0U);
  return polygon;
}

/// A star of 2·n corners with radii 1 and `inner`, in a plane that no axis is normal to.
std::vector<glm::vec3> star(int n, double inner) {
  std::vector<glm::vec3> points;
  const glm::dvec3 u = glm::normalize(glm::dvec3(1, 2, -1)), v = glm::normalize(glm::dvec3(1, 0, 1));
  for (int i = 0; i < 2 * n; ++i) {
    const double angle = std::numbers::pi * i / n, r = i % 2 == 0 ? 1 : inner;
    points.emplace_back(u * (r * std::cos(angle)) + v * (r * std::sin(angle)) + glm::dvec3(3, -2, 5));
  }
  return points;
}

TEST(TriangulatePolygon, StarsOfAnyDepth_CoverTheAreaOnceAndKeepTheWinding) {
  for (const int n : {3, 5, 12, 100})
    for (const double inner : {0.05, 0.3, 0.9}) {
      SCOPED_TRACE(testing::Message() << n << " rays, inner radius " << inner);
      const std::vector<glm::vec3> points = star(n, inner);
      std::vector<glm::uvec3> triangles;
      EXPECT_TRUE(triangulate_polygon(points, iota(points.size()), triangles));
      EXPECT_EQ(triangles.size(), points.size() - 2);
      // 2n triangles about the centre with sides 1 and `inner`, at an angle of π/n.
      const double expected = n * inner * std::sin(std::numbers::pi / n);
      EXPECT_NEAR(area(points, triangles), expected, 1e-5 * expected);
      const glm::dvec3 normal =
          glm::cross(glm::normalize(glm::dvec3(1, 2, -1)), glm::normalize(glm::dvec3(1, 0, 1)));
      for (const glm::uvec3& t : triangles)
        EXPECT_GT(
            glm::dot(normal, glm::dvec3(glm::cross(points[t.y] - points[t.x], points[t.z] - points[t.x]))),
            0);
    }
}

TEST(TriangulatePolygon, ConcaveQuadWithTheDentAtAnyCorner_StaysInside) {
  const std::vector<glm::vec3> dart{{0, 0, 0}, {4, -1, 0}, {1, 0, 0}, {4, 1, 0}};  // Dent at corner 2.
  for (std::uint32_t turn = 0; turn < 4; ++turn) {
    std::vector<std::uint32_t> polygon;
    for (std::uint32_t i = 0; i < 4; ++i) polygon.push_back((i + turn) % 4);
    std::vector<glm::uvec3> triangles;
    EXPECT_TRUE(triangulate_polygon(dart, polygon, triangles));
    EXPECT_NEAR(area(dart, triangles), 1.0, 1e-6);
  }
}

TEST(TriangulatePolygon, ConvexQuad_IsCutAlongTheShorterDiagonal) {
  const std::vector<glm::vec3> kite{{0, 0, 0}, {3, -1, 0}, {6, 0, 0}, {3, 1, 0}};
  std::vector<glm::uvec3> triangles;
  EXPECT_TRUE(triangulate_polygon(kite, iota(4), triangles));
  ASSERT_EQ(triangles.size(), 2u);
  EXPECT_EQ(triangles[0], glm::uvec3(1, 2, 3));
  EXPECT_EQ(triangles[1], glm::uvec3(1, 3, 0));
}

TEST(TriangulatePolygon, RepeatedNeighbours_AreLeftOut) {
  const std::vector<glm::vec3> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  std::vector<glm::uvec3> triangles;
  EXPECT_TRUE(triangulate_polygon(square, std::vector<std::uint32_t>{0, 1, 1, 2, 3, 0}, triangles));
  EXPECT_EQ(triangles.size(), 2u);
  EXPECT_NEAR(area(square, triangles), 1, 1e-6);
}

TEST(TriangulatePolygon, CornersOnAStraightLine_AreAllKept) {
  const std::vector<glm::vec3> points{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 2, 0}, {0, 2, 0}};
  std::vector<glm::uvec3> triangles;
  EXPECT_TRUE(triangulate_polygon(points, iota(6), triangles));
  EXPECT_EQ(triangles.size(), 4u);
  EXPECT_NEAR(area(points, triangles), 4, 1e-6);
}

TEST(TriangulatePolygon, PolygonThatCrossesItself_SaysSoAndHasAllItsTriangles) {
  std::vector<glm::vec3> pentagram;
  for (int i = 0; i < 5; ++i) {
    const double angle = 4 * std::numbers::pi * i / 5;
    pentagram.emplace_back(std::cos(angle), std::sin(angle), 1);
  }
  pentagram.emplace_back(0.9f, 0.3f, 1);
  std::vector<glm::uvec3> triangles;
  EXPECT_FALSE(triangulate_polygon(pentagram, iota(6), triangles));
  EXPECT_EQ(triangles.size(), 4u);
}

TEST(TriangulatePolygon, CombOfManyCorners_IsDoneInBoundedTime) {
  // Every corner between the teeth is inside of none of the ears, but has to be looked at.
  std::vector<glm::vec3> comb;
  for (int i = 0; i < 10'000; ++i) {
    comb.emplace_back(2 * i, 0, 0);
    comb.emplace_back(2 * i + 1, i % 2 == 0 ? 2e4f : 1, 0);
  }
  comb.emplace_back(2e4f, -2e4f, 0);
  std::vector<glm::uvec3> triangles;
  triangulate_polygon(comb, iota(comb.size()), triangles);
  EXPECT_EQ(triangles.size(), comb.size() - 2);
}

TEST(TriangulatePolygon, WithoutAreaOrNotFinite_IsAFanAndSaysSo) {
  const std::vector<glm::vec3> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}};
  std::vector<glm::uvec3> triangles;
  EXPECT_FALSE(triangulate_polygon(line, iota(5), triangles));
  EXPECT_EQ(triangles.size(), 3u);
  const std::vector<glm::vec3> nan{{0, 0, 0}, {1, NAN, 0}, {2, 0, 0}, {3, 4, 0}, {4, 0, 0}};
  triangles.clear();
  EXPECT_FALSE(triangulate_polygon(nan, iota(5), triangles));
  EXPECT_EQ(triangles.size(), 3u);
}

/// The outer square 0 1 2 3 of a sheet with a vertex 4 inside of it that two quadrilaterals have.
struct FoldedQuads {
  std::vector<glm::vec3> positions{{-1, 0, 0}, {0, -1, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0.1f}};
  std::vector<std::uint32_t> faces;
  std::vector<glm::uvec3> triangles;

  void add(const std::vector<std::uint32_t>& polygon) {
    triangulate_polygon(positions, polygon, triangles);
    faces.resize(triangles.size(), faces.empty() ? 0 : faces.back() + 1);
  }
  std::size_t n_repeated() const {
    std::set<std::set<std::uint32_t>> sets;
    for (const glm::uvec3& t : triangles) sets.insert({t.x, t.y, t.z});
    return triangles.size() - sets.size();
  }
};

TEST(PartFoldedQuads, TwoThatShareThreeVertices_AreCutAlongDifferentDiagonals) {
  for (const bool is_first_cut : {false, true}) {
    FoldedQuads quads;
    quads.faces = {0, 0, 1, 1};
    quads.triangles = {{0, 1, 2}, {0, 2, 4}, {2, 3, 0}, {2, 0, 4}};
    // Of one of them the cut lies outside.
    quads.positions[4] = {0, is_first_cut ? -0.5f : 0.5f, 0.1f};
    EXPECT_EQ(quads.n_repeated(), 1u);
    part_folded_quads(quads.positions, quads.faces, quads.triangles);
    EXPECT_EQ(quads.n_repeated(), 0u);
    double area = 0;
    for (const glm::uvec3& t : quads.triangles) {
      const glm::vec3 n = glm::cross(quads.positions[t.y] - quads.positions[t.x],
                                     quads.positions[t.z] - quads.positions[t.x]);
      EXPECT_GT(n.z, 0);
      area += 0.5 * double(n.z);
    }
    EXPECT_NEAR(area, 2, 1e-6);
  }
}

TEST(PartFoldedQuads, OtherPolygons_StayAsTheyAre) {
  FoldedQuads quads;
  quads.add({0, 1, 2, 4});
  quads.add({0, 4, 2});
  quads.add({2, 3, 0});
  quads.add({0, 3, 2, 1, 4});
  const std::vector<glm::uvec3> before = quads.triangles;
  part_folded_quads(quads.positions, quads.faces, quads.triangles);
  EXPECT_EQ(quads.triangles, before);
}

}  // namespace
}  // namespace lambake
