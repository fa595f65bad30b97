#include "lambake/geometry/normal_sums.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "lambake/core/parallel.h"
#include "lambake/core/vector_path.h"
#include "shapes.h"

namespace lambake {
namespace {

constexpr std::array every_weight = {NormalWeight::angle, NormalWeight::area, NormalWeight::uniform,
                                     NormalWeight::max};

struct Random {
  std::mt19937 engine{11};
  float operator()(float low, float high) {
    return low + (high - low) * static_cast<float>(engine()) / 4294967296.0f;
  }
};

struct PlainSum {
  glm::dvec3 normal{0};
  double weight = 0;
};

/// The sums around each vertex as the definition has them, in double and in the order of the faces.
std::vector<PlainSum> plain_sums(const Mesh& mesh, NormalWeight weight) {
  std::vector<PlainSum> sums(mesh.n_vertices());
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 p[3] = {glm::dvec3(mesh.positions[t[0]]), glm::dvec3(mesh.positions[t[1]]),
                             glm::dvec3(mesh.positions[t[2]])};
    const glm::dvec3 cross = glm::cross(p[1] - p[0], p[2] - p[0]);
    const double area = glm::length(cross);
    const double longest =
        std::max({glm::length(p[1] - p[0]), glm::length(p[2] - p[0]), glm::length(p[2] - p[1])});
    if (!(area > 1e-12 * longest * longest)) continue;
    for (int c = 0; c < 3; ++c) {
      const glm::dvec3 a = p[(c + 1) % 3] - p[c], b = p[(c + 2) % 3] - p[c];
      const double w = weight == NormalWeight::angle     ? std::atan2(area, glm::dot(a, b))
                       : weight == NormalWeight::area    ? area
                       : weight == NormalWeight::uniform ? 1
                                                         : area / (glm::dot(a, a) * glm::dot(b, b));
      sums[t[c]].normal += cross * (w / area);
      sums[t[c]].weight += w;
    }
  }
  return sums;
}

/// The largest difference to the definition, where that has a direction.
double worst_difference(const Mesh& mesh, NormalWeight weight) {
  const std::vector<glm::vec3> found = vertex_normals(mesh, weight).normals;
  const std::vector<PlainSum> expected = plain_sums(mesh, weight);
  double worst = 0;
  for (std::size_t v = 0; v < found.size(); ++v) {
    const double length = glm::length(expected[v].normal);
    if (!(length > 2e-6 * expected[v].weight)) continue;
    worst = std::max(worst, glm::length(glm::dvec3(found[v]) - expected[v].normal / length));
  }
  return worst;
}

/// A rough patch, stretched, moved and scaled.
Mesh patch(float stretch, float offset, float scale) {
  Random random;
  Mesh mesh = height_field(40);
  for (glm::vec3& p : mesh.positions) {
    p += glm::vec3(random(-0.005f, 0.005f), random(-0.005f, 0.005f), random(-0.005f, 0.005f));
    p = (p * glm::vec3(stretch, 1, 1) + glm::vec3(offset)) * scale;
  }
  return mesh;
}

TEST(NormalSums, AnyShapePlaceAndSize_AsInDouble) {
  // Each weighted normal is off by a few ulp of float, some 1e-7 of its weight; sums are well conditioned
  // here.
  for (const NormalWeight weight : every_weight)
    for (const float stretch : {1.0f, 1e3f, 1e5f, 1e-4f})
      for (const float offset : {0.0f, 1.0f, 1e3f})
        for (const float scale : {1.0f, 1e-12f, 1e-18f, 1e12f, 1e18f})
          EXPECT_LT(worst_difference(patch(stretch, offset, scale), weight), 4e-7)
              << static_cast<int>(weight) << " " << stretch << " " << offset << " " << scale;
}

TEST(NormalSums, FacesFarSmallerAndLargerThanTheMesh_AsInDouble) {
  // The size of a mesh is taken from a thousand of its vertices.
  for (const float scale : {1e-9f, 1e-14f, 1e12f, 1e17f}) {
    Mesh mesh = patch(1, 0, 1);
    const Mesh other = patch(1, 0, scale);
    const auto n = static_cast<std::uint32_t>(mesh.n_vertices());
    for (int copies = 0; copies < (scale > 1 ? 1 : 2); ++copies) {
      mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
      const auto first = n + static_cast<std::uint32_t>(copies * other.n_vertices());
      for (const glm::uvec3& t : other.triangles) mesh.triangles.push_back(t + first);
    }
    for (const NormalWeight weight : every_weight)
      EXPECT_LT(worst_difference(mesh, weight), 4e-7) << static_cast<int>(weight) << " " << scale;
  }
}

TEST(NormalSums, LargeSliversOutsideTheSample_AsInDouble) {
  // Sides of 1e10 units, whose squares' product is past float, though the area is not. Every fifth vertex is
  // in the sample, and none of these.
  Mesh mesh = height_field(70);
  const auto n = static_cast<std::uint32_t>(mesh.n_vertices());
  ASSERT_EQ(n, 5041U);
  mesh.positions.insert(mesh.positions.end(), {{0, 0, 1}, {1e10f, 1e3f, 1}, {1e10f, -1e3f, 1}});
  mesh.triangles.emplace_back(n, n + 2, n + 1);
  for (const NormalWeight weight : every_weight)
    EXPECT_LT(worst_difference(mesh, weight), 4e-7) << static_cast<int>(weight);
}

/// A height field of several windows of vertices, whose faces are in order but for some that name vertices
/// far away, and for some that are the reverse of others, so that sums nearly cancel.
Mesh mostly_in_order() {
  Mesh mesh = height_field(400);
  const auto n = static_cast<std::uint32_t>(mesh.n_vertices());
  const std::vector<glm::uvec3> faces = mesh.triangles;
  const auto insert = [&](std::size_t at, const glm::uvec3& face) {
    mesh.triangles.insert(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(at), face);
  };
  // Two in the same chunk, so that it meets the same windows twice.
  for (std::uint32_t i = 0; i < 9; ++i)
    for (std::uint32_t k = 0; k < 2; ++k)
      insert(30003 * (i + 1) + 100, {31 + 977 * i + k, n - 1 - 12345 * i - k, n / 2 + 701 * i + k});
  for (const std::uint32_t v : {7000U, 70007U, 150001U})
    for (std::size_t f = 0, n_reversed = 0; f < faces.size() && n_reversed < 5; ++f)
      if (const glm::uvec3& t = faces[f]; t.x == v || t.y == v || t.z == v) {
        insert(2 * v + 50, {t.x, t.z, t.y});
        ++n_reversed;
      }
  return mesh;
}

TEST(NormalSums, FacesThatReachFar_AsInDouble) {
  Mesh mesh = mostly_in_order();
  for (const NormalWeight weight : every_weight)
    EXPECT_LT(worst_difference(mesh, weight), 4e-7) << static_cast<int>(weight);
  // In so many places that guesses would be of no use.
  const auto n = static_cast<std::uint32_t>(mesh.n_vertices());
  for (std::uint32_t i = 100; i < mesh.triangles.size(); i += 1001)
    mesh.triangles[i].z = (mesh.triangles[i].z + 7919 * i) % n;
  EXPECT_LT(worst_difference(mesh, NormalWeight::angle), 4e-7);
}

/// n triangles around a lopsided tip, vertex 0.
Mesh needles(std::uint32_t n) {
  Random random;
  Mesh mesh;
  mesh.positions.emplace_back(0.2f, 0.1f, 1);
  for (std::uint32_t i = 0; i < n; ++i) {
    const double turn = (i + double(random(-0.3f, 0.3f))) * 2 * 3.14159265358979 / n;
    mesh.positions.emplace_back(std::cos(turn), std::sin(turn), 0.3 * std::sin(3 * turn));
    mesh.triangles.emplace_back(0, 1 + i, 1 + (i + 1) % n);
  }
  return mesh;
}

TEST(NormalSums, FansOfNeedles_KeepTheirWeights) {
  // Tiny angles count as much as their sum.
  for (const NormalWeight weight : every_weight)
    EXPECT_LT(worst_difference(needles(30000), weight), 4e-7) << static_cast<int>(weight);
}

/// Numbered without order, so that no two chunks of faces can be added side by side; with faces of every odd
/// kind.
Mesh shuffled() {
  Mesh mesh = icosphere(6);
  Random random;
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random.engine);
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  for (const glm::vec3& p :
       {glm::vec3(nan, 0, 0), glm::vec3(0, infinity, 1), glm::vec3(1e30f, 1, 1), glm::vec3(0)})
    mesh.positions.push_back(p);
  const auto n = static_cast<std::uint32_t>(mesh.n_vertices());
  for (std::uint32_t i = 0; i < 40; ++i)
    mesh.triangles.insert(mesh.triangles.begin() + 100 * i, {i, i * i, n - 1 - i % 4});
  return mesh;
}

TEST(NormalSums, AnyNumberOfThreads_SameBits_HoweverVerticesAreNumbered) {
  // All faces of the needles add to one vertex.
  for (const Mesh& mesh : {shuffled(), mostly_in_order(), needles(200000)}) {
    set_thread_count(1);
    const VertexNormals one = vertex_normals(mesh, NormalWeight::angle);
    set_thread_count(0);
    for (int i = 0; i < 5; ++i) {
      const VertexNormals all = vertex_normals(mesh, NormalWeight::angle);
      EXPECT_EQ(all.normals, one.normals);
      EXPECT_EQ(all.undefined, one.undefined);
    }
  }
}

TEST(NormalSums, EveryVectorPath_SameBits) {
  for (const Mesh& mesh : {shuffled(), mostly_in_order()})
    for (const NormalWeight weight : every_weight) {
      const std::vector<glm::vec3> best = vertex_normals(mesh, weight).normals;
      for (const std::string& path : vector_paths()) {
        choose_vector_path(path);
        EXPECT_EQ(vertex_normals(mesh, weight).normals, best) << path;
      }
      choose_vector_path("");
    }
}

TEST(NormalSums, OneVertexInManyFaces_IsReadWithinItsArray) {
  Mesh mesh;
  mesh.positions = {{1, 2, 3}};
  mesh.triangles.assign(200, {0, 0, 0});
  EXPECT_EQ(vertex_normals(mesh, NormalWeight::angle).normals, std::vector{glm::vec3(0)});
}

TEST(NormalSums, Groups_AreSummedAsOneVertex_InAnyNumbering) {
  // Every triangle has its own three copies, after the vertices of the file, which no face names.
  const Mesh whole = icosphere(5);
  Mesh apart = whole;
  apart.source_vertices.resize(whole.n_vertices());
  for (std::uint32_t v = 0; v < whole.n_vertices(); ++v) apart.source_vertices[v] = v;
  for (glm::uvec3& t : apart.triangles)
    for (int c = 0; c < 3; ++c) t[c] = append_vertex_copy(apart, t[c]);
  const VertexNormals expected = vertex_normals(whole, NormalWeight::angle);
  const VertexNormals found = vertex_normals(apart, NormalWeight::angle);
  EXPECT_EQ(found.undefined, 0U);
  for (std::size_t v = 0; v < apart.n_vertices(); ++v)
    ASSERT_EQ(found.normals[v], expected.normals[apart.source_vertices[v]]) << v;
}

}  // namespace
}  // namespace lambake
