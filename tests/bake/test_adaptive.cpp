#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

#include "lambake/bake/bake.h"
#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/geometry/creases.h"
#include "lambake/io/mesh_file.h"
#include "lambake/measure/bound.h"
#include "lambake/measure/surface_error.h"
#include "measure/scenes.h"

namespace lambake {
namespace {

double area_of(const Mesh& mesh) {
  double sum = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 p(mesh.positions[t[0]]);
    sum += 0.5 * glm::length(
                     glm::cross(glm::dvec3(mesh.positions[t[1]]) - p, glm::dvec3(mesh.positions[t[2]]) - p));
  }
  return sum;
}

using Point = std::array<float, 3>;
Point point(const glm::vec3& p) {
  return {p.x, p.y, p.z};
}

/// Sides of triangles by the positions of their ends, whatever vertices are there: how often each occurs.
std::map<std::pair<Point, Point>, int> sides_of(const Mesh& mesh) {
  std::map<std::pair<Point, Point>, int> sides;
  for (const glm::uvec3& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) {
      const Point a = point(mesh.positions[t[c]]), b = point(mesh.positions[t[(c + 1) % 3]]);
      ++sides[std::minmax(a, b)];
    }
  return sides;
}

std::size_t n_open_sides(const Mesh& mesh) {
  std::size_t n = 0;
  for (const auto& [side, count] : sides_of(mesh)) n += count != 2;
  return n;
}

BakedColors bake_adaptively(const Scene& scene, double tolerance = 1.0 / 255,
                            ErrorSpace space = ErrorSpace::display) {
  return bake(scene, {.method = BakeMethod::adaptive, .tolerance = tolerance, .tolerance_space = space});
}

TEST(Adaptive, FanOfFlatFacets_TakesOfTheRoomForVerticesWhatItMakes) {
  // Each facet has a copy of the apex: a cut of all ridges makes two vertices each, not one for each pair.
  constexpr unsigned n = 400;
  Mesh mesh;
  for (unsigned i = 0; i < n; ++i) {
    const auto rim = [&](unsigned k) {
      const float angle = 6.2831853f * static_cast<float>(k % n) / n;
      return glm::vec3(std::cos(angle), 0, -std::sin(angle));
    };
    const std::uint32_t first = 3 * i;
    for (const glm::vec3& p : {glm::vec3(0, 0.7f, 0), rim(i), rim(i + 1)}) mesh.positions.push_back(p);
    const glm::vec3* const p = &mesh.positions[first];
    mesh.normals.insert(mesh.normals.end(), 3, glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0])));
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  const BakedColors baked = bake_adaptively(scene_of(mesh, {lamp({0.5f, 1.2f, 0})}));
  EXPECT_TRUE(baked.certificate->is_certified) << 255 * baked.certificate->max_bound;
  EXPECT_LT(baked.mesh->n_vertices(), 20000U);
}

TEST(Adaptive, SmallScenes_AreCertifiedAndMeasuredWithinTheTolerance) {
  for (const NamedScene& s : small_scenes()) {
    SCOPED_TRACE(s.name);
    const BakedColors baked = bake_adaptively(s.scene);
    ASSERT_TRUE(baked.certificate && baked.mesh);
    EXPECT_TRUE(baked.certificate->is_certified);
    EXPECT_LE(baked.certificate->max_bound, 1.0 / 255);
    EXPECT_LE(surface_error(s.scene, baked, ErrorSpace::display).max_sampled, 1.0 / 255);
    // The finished result bounded from outside: the same cuts, the colours as they are stored.
    BoundOptions options;
    options.accept = 1.0 / 255, options.tightness = 1;
    EXPECT_LE(surface_bound(s.scene, baked, options).max_bound, 1.0 / 255 + 1e-9);
  }
}

TEST(Adaptive, SmallScenes_KeepTheSurfaceAndTheOriginalVertices) {
  for (const NamedScene& s : small_scenes()) {
    SCOPED_TRACE(s.name);
    const Mesh& before = s.scene.mesh;
    const BakedColors baked = bake_adaptively(s.scene);
    const Mesh& after = *baked.mesh;
    check_mesh(after, s.scene.materials.size());
    EXPECT_NEAR(area_of(after), area_of(before), 1e-6 * area_of(before));
    ASSERT_EQ(after.n_vertices(), before.n_vertices() + baked.cuts.size());
    ASSERT_EQ(baked.colors.size(), after.n_vertices());
    ASSERT_EQ(baked.parent_triangles.size(), after.n_triangles());
    for (std::size_t v = 0; v < before.n_vertices(); ++v) {
      EXPECT_EQ(after.positions[v], before.positions[v]);
      EXPECT_EQ(after.normals[v], before.normals[v]);
    }
    for (std::size_t i = 0; i < baked.cuts.size(); ++i) {
      const EdgeCut& cut = baked.cuts[i];
      const std::size_t v = before.n_vertices() + i;
      ASSERT_LT(std::max(cut.a, cut.b), v);
      const glm::vec3 expected = glm::mix(after.positions[cut.a], after.positions[cut.b], cut.t);
      EXPECT_LT(glm::length(after.positions[v] - expected), 1e-6f);
      EXPECT_NEAR(glm::length(after.normals[v]), 1, 1e-6);
    }
    for (std::size_t f = 0; f < after.n_triangles(); ++f) {
      const auto normal = [](const Mesh& mesh, const glm::uvec3& t) {
        return glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                          mesh.positions[t[2]] - mesh.positions[t[0]]);
      };
      EXPECT_GE(glm::dot(normal(after, after.triangles[f]),
                         normal(before, before.triangles[baked.parent_triangles[f]])),
                -1e-12f)
          << "triangle " << f << " is turned over";
    }
  }
}

TEST(Adaptive, ClosedMeshes_StayClosedWithoutTJunctions) {
  const Light lamp_near = lamp({0.9f, 1.2f, 0.5f}, {0.5f, 0.4f, 0.3f});
  EXPECT_EQ(n_open_sides(*bake_adaptively(scene_of(icosphere(2), {sun({0.4f, 1, 0.3f}), lamp_near})).mesh),
            0U);
  // Creases: the copies of an edge on both sides have different normals and are cut together.
  Mesh box = rounded_box(4);
  split_creases(box, 0.6f);
  ASSERT_GT(box.n_vertices(), rounded_box(4).n_vertices());
  const BakedColors baked = bake_adaptively(scene_of(box, {sun({0.4f, 0.3f, 0.3f}), lamp_near}));
  EXPECT_GT(baked.cuts.size(), 20U);
  EXPECT_EQ(n_open_sides(*baked.mesh), 0U);
}

TEST(Adaptive, SphereUnderASunAndQuadUnderALamp_NeedFewTriangles) {
  const std::size_t most[] = {450, 1480, 5490};
  for (unsigned level = 2; level <= 4; ++level) {
    const BakedColors baked = bake_adaptively(scene_of(icosphere(level), {sun({0.4f, 1, 0.3f})}));
    EXPECT_TRUE(baked.certificate->is_certified);
    EXPECT_LE(baked.mesh->n_triangles(), most[level - 2]);
  }
  const float bright = 0.0625f;  // 1 in the middle
  const BakedColors quad = bake_adaptively(
      scene_of(grid(1, 1), {lamp({0, 0.25f, 0}, {bright, bright, bright})}), 1.0 / 255, ErrorSpace::linear);
  EXPECT_TRUE(quad.certificate->is_certified);
  EXPECT_LE(quad.mesh->n_triangles(), 1600U);
}

// Cut at terminators, with sampled colours, it takes 34,116; quartering is not there with 745,032.
TEST(Adaptive, RockerArmUnderASun_TakesHalfAsManyTrianglesMore) {
  Mesh mesh = read_mesh_file(LAMBAKE_SOURCE_DIR "/../shared/meshes/cad/rocker-arm.off").scene.mesh;
  ASSERT_EQ(mesh.n_triangles(), 20088U);
  mesh.normals.clear();
  const BakedColors baked = bake_adaptively(scene_of(mesh, {sun({0.4f, 1, 0.3f})}));
  EXPECT_TRUE(baked.certificate->is_certified);
  EXPECT_LE(baked.mesh->n_triangles(), 29000U);
}

// A seam may not show: copies of a vertex that get the same light keep one colour.
TEST(Adaptive, CopiesOfAVertex_AreBalancedTogether) {
  Mesh seamed = icosphere(2);
  std::vector<std::uint32_t> copy_of(seamed.n_vertices());
  for (std::uint32_t v = 0, n = static_cast<std::uint32_t>(copy_of.size()); v < n; ++v)
    copy_of[v] = append_vertex_copy(seamed, v);
  for (glm::uvec3& t : seamed.triangles)
    if (seamed.positions[t.x].y > 0.3f)
      for (int c = 0; c < 3; ++c) t[c] = copy_of[t[c]];
  const BakedColors baked = bake_adaptively(scene_of(seamed, {sun({0.4f, 1, 0.3f})}));
  ASSERT_GT(baked.cuts.size(), 10U);
  std::map<Point, LinearRgb> colors;
  std::size_t n_balanced = 0;
  for (const glm::uvec3& t : baked.mesh->triangles)
    for (int c = 0; c < 3; ++c) {
      const auto [known, is_new] = colors.try_emplace(point(baked.mesh->positions[t[c]]), baked.colors[t[c]]);
      EXPECT_EQ(known->second, baked.colors[t[c]]);
    }
  for (const auto& [place, color] : colors)
    n_balanced += color.r > 0 && color.r > glm::dot(glm::vec3(place[0], place[1], place[2]),
                                                    glm::normalize(glm::vec3(0.4f, 1, 0.3f))) +
                                               1e-4f;
  EXPECT_GT(n_balanced, 10U);
}

TEST(Adaptive, FlatFacesUnderASun_AreNotCut) {
  const BakedColors baked = bake_adaptively(scene_of(grid(4, 1), {sun({0.4f, 1, 0.3f})}));
  EXPECT_TRUE(baked.cuts.empty());
  EXPECT_EQ(baked.mesh->n_triangles(), 32U);
}

// A hundred weak suns add up to something smooth: no terminator matters.
TEST(Adaptive, HundredWeakLights_DoNotShredTheMesh) {
  std::mt19937 engine(3);
  const auto coordinate = [&] { return static_cast<float>(engine()) / 2147483648.0f - 1; };
  std::vector<Light> lights;
  while (lights.size() < 100) {
    const glm::vec3 d(coordinate(), std::abs(coordinate()), coordinate());
    if (glm::length(d) > 0.1f) lights.push_back(sun(d, {0.02f, 0.02f, 0.02f}));
  }
  const BakedColors baked = bake_adaptively(scene_of(icosphere(3), lights), 2.0 / 255);
  EXPECT_TRUE(baked.certificate->is_certified);
  EXPECT_LT(baked.mesh->n_triangles(), 1500U);
}

TEST(Adaptive, MaxVertices_StopsThereAndSaysSo) {
  const Scene scene = scene_of(icosphere(2), {sun({0.4f, 1, 0.3f})});
  const BakedColors baked =
      bake(scene, {.method = BakeMethod::adaptive, .tolerance = 1.0 / 255, .max_vertices = 200});
  EXPECT_LE(baked.mesh->n_vertices(), 200U);
  EXPECT_GT(baked.mesh->n_vertices(), scene.mesh.n_vertices());
  EXPECT_FALSE(baked.certificate->is_certified);
  EXPECT_GT(baked.certificate->open_triangles, 0U);
  EXPECT_GE(baked.certificate->max_bound, surface_error(scene, baked, ErrorSpace::display).max_sampled);
  const auto is_open = [](const Finding& f) { return f.code == "open_triangles"; };
  const auto told = std::find_if(baked.findings.begin(), baked.findings.end(), is_open);
  ASSERT_NE(told, baked.findings.end());
  EXPECT_NE(told->text.find("no more vertices may be made"), std::string::npos) << told->text;
}

/// Barycentrics in the triangle of the foot of p in its plane.
glm::dvec3 barycentrics_of(const Mesh& mesh, const glm::uvec3& t, const glm::dvec3& p) {
  const glm::dvec3 o(mesh.positions[t[0]]), e1 = glm::dvec3(mesh.positions[t[1]]) - o,
                                            e2 = glm::dvec3(mesh.positions[t[2]]) - o, d = p - o;
  const double a = glm::dot(e1, e1), b = glm::dot(e1, e2), c = glm::dot(e2, e2);
  const double x = glm::dot(d, e1), y = glm::dot(d, e2), det = a * c - b * b;
  const double b1 = (c * x - b * y) / det, b2 = (a * y - b * x) / det;
  return {1 - b1 - b2, b1, b2};
}

/// The largest difference on screen between the mesh as its floats have it and light per pixel at the same
/// places of the scene's surface, at ten places of each triangle. One sun.
double error_as_stored(const Scene& scene, const BakedColors& baked) {
  double worst = 0;
  for (std::size_t f = 0; f < baked.mesh->n_triangles(); ++f) {
    const glm::uvec3 t = baked.mesh->triangles[f], whole = scene.mesh.triangles[baked.parent_triangles[f]];
    for (int i = 0; i <= 3; ++i)
      for (int j = 0; i + j <= 3; ++j) {
        const glm::dvec3 b(i / 3.0, j / 3.0, (3 - i - j) / 3.0);
        glm::dvec3 place(0), normal(0);
        double shown = 0;
        for (int c = 0; c < 3; ++c) {
          place += b[c] * glm::dvec3(baked.mesh->positions[t[c]]);
          shown += b[c] * baked.colors[t[c]].r;
        }
        const glm::dvec3 there = barycentrics_of(scene.mesh, whole, place);
        for (int c = 0; c < 3; ++c) normal += there[c] * glm::dvec3(scene.mesh.normals[whole[c]]);
        const double cosine =
            glm::dot(glm::normalize(normal), glm::dvec3(scene.lights[0].direction_to_light));
        worst = std::max(worst, std::abs(compared(shown, ErrorSpace::display) -
                                         compared(std::max(0.0, cosine), ErrorSpace::display)));
      }
  }
  return worst;
}

// Cut vertices are rounded to float, which far from the origin is no small share of a triangle.
TEST(Adaptive, FarFromTheOrigin_WhatTheRoundedMeshShowsIsWithinTheBound) {
  for (const float distance : {0.0f, 1e4f, 1e6f, 4e6f}) {
    Mesh mesh = icosphere(3);
    for (glm::vec3& p : mesh.positions) p = glm::round(p * 64.0f) * 0.5f + glm::vec3(distance);
    const Scene scene = scene_of(std::move(mesh), {sun({0.4f, 1, 0.3f})});
    const BakedColors baked = bake_adaptively(scene);
    EXPECT_LE(error_as_stored(scene, baked), baked.certificate->max_bound) << distance;
    EXPECT_LE(error_as_stored(scene, baked), surface_bound(scene, baked, {}).max_bound) << distance;
    EXPECT_EQ(baked.certificate->is_certified, distance < 1e5f) << distance;
    std::size_t n_told = 0;
    for (const Finding& finding : baked.findings)
      if (finding.code == "triangles_open_by_position") n_told = finding.count;
    EXPECT_EQ(n_told > 0, distance > 1e5f) << distance;
  }
}

TEST(Adaptive, NoTimeAtAll_LeavesTheMeshUncutAndWithoutABound) {
  const Scene scene = scene_of(icosphere(2), {sun({0.4f, 1, 0.3f})});
  const BakedColors baked = bake(scene, {.method = BakeMethod::adaptive, .max_seconds = 1e-9});
  EXPECT_EQ(baked.mesh->n_triangles(), scene.mesh.n_triangles());
  EXPECT_FALSE(baked.certificate->is_certified);
  EXPECT_TRUE(std::isinf(baked.certificate->max_bound));
  ASSERT_FALSE(baked.findings.empty());
  EXPECT_EQ(baked.findings[0].code, "triangles_not_bounded");
  EXPECT_EQ(baked.findings[0].count, scene.mesh.n_triangles());
}

TEST(Adaptive, StoredColours_AreWhatIsCertified) {
  const Scene scene = scene_of(icosphere(2), {sun({0.4f, 1, 0.3f})});
  const auto to_u8 = [](float x) { return std::round(std::clamp(x, 0.0f, 1.0f) * 255) / 255; };
  const ColorOutput output = storing([&](const LinearRgb& c) {
    return LinearRgb{to_u8(c.r), to_u8(c.g), to_u8(c.b)};
  });
  BakedColors baked = bake(scene, {.method = BakeMethod::adaptive, .tolerance = 8.0 / 255, .output = output});
  take_stored_colors(scene, output, baked);
  EXPECT_TRUE(baked.certificate->is_certified);
  EXPECT_LE(surface_error(scene, baked, ErrorSpace::display).max_sampled, 8.0 / 255);
}

// Rounding takes half of the tolerance; what is left is cut for, and the colours are balanced within it.
TEST(Adaptive, BytesOfPly_AreCertifiedWithLittleMore) {
  const Scene scene = scene_of(torus_knot(240, 24, 0.2f), {sun({0.4f, 1, 0.3f})});
  BakeOptions options{.method = BakeMethod::adaptive};
  const std::size_t n_exact = bake(scene, options).mesh->n_triangles();
  options.output = storing([](const LinearRgb& c) { return to_linear(to_srgb8(c)); });
  BakedColors baked = bake(scene, options);
  take_stored_colors(scene, options.output, baked);
  EXPECT_TRUE(baked.certificate->is_certified);
  EXPECT_LE(surface_error(scene, baked, ErrorSpace::display).max_sampled, 1.0 / 255);
  EXPECT_LT(baked.mesh->n_triangles(), n_exact * 5 / 4);
}

// What a clipped colour loses no cut brings back: cutting would never end.
TEST(Adaptive, ColoursThatTheOutputClips_AreToldAndNotCutFor) {
  Scene scene = scene_of(icosphere(2), {sun({0.4f, 1, 0.3f}, {1.5f, 1.5f, 1.5f})});
  scene.materials[0].base_color = {0.5f, 0.5f, 0.5f};
  const BakeOptions plain{.method = BakeMethod::adaptive};
  BakeOptions clipping = plain;
  clipping.output = storing([](const LinearRgb& c) {
    return LinearRgb{std::min(c.r, 1.0f), std::min(c.g, 1.0f), std::min(c.b, 1.0f)};
  });
  const BakedColors exact = bake(scene, plain);
  BakedColors clipped = bake(scene, clipping);
  EXPECT_TRUE(exact.certificate->is_certified);
  EXPECT_FALSE(clipped.certificate->is_certified);
  EXPECT_EQ(clipped.mesh->n_triangles(), exact.mesh->n_triangles());
  const auto brightest = [&] {
    return std::max_element(clipped.colors.begin(), clipped.colors.end(),
                            [](auto& a, auto& b) { return a.r < b.r; })
        ->r;
  };
  EXPECT_GT(brightest(), 1.0f);  // Other outputs may hold it.
  take_stored_colors(scene, clipping.output, clipped);
  EXPECT_EQ(brightest(), 1.0f);
  EXPECT_GE(clipped.certificate->max_bound, surface_error(scene, clipped, ErrorSpace::display).max_sampled);
  std::size_t n_told = 0;
  for (const Finding& finding : clipped.findings)
    if (finding.code == "triangles_open_by_storage") n_told = finding.count;
  EXPECT_EQ(n_told, clipped.certificate->open_triangles);
}

// What the screen clips as well is not lost: the edge of white is cut like a terminator.
TEST(Adaptive, ColoursThatScreenAndOutputClip_AreCertified) {
  const Scene scene = scene_of(icosphere(3), {sun({0.4f, 1, 0.3f}, {1.5f, 1.2f, 0.9f})});
  const ColorOutput output = storing([](const LinearRgb& c) {
    return LinearRgb{std::min(c.r, 1.0f), std::min(c.g, 1.0f), std::min(c.b, 1.0f)};
  });
  BakedColors baked = bake(scene, {.method = BakeMethod::adaptive, .output = output});
  take_stored_colors(scene, output, baked);
  EXPECT_TRUE(baked.certificate->is_certified);
  EXPECT_LT(baked.mesh->n_triangles(), 2500U);
  EXPECT_LE(surface_error(scene, baked, ErrorSpace::display).max_sampled, 1.0 / 255);
}

TEST(Adaptive, LampOnTheSurface_EndsUncertified) {
  Mesh mesh = grid(2, 1);
  for (const glm::vec3& p : mesh.positions)
    mesh.normals.push_back(glm::normalize(glm::vec3(0, 1, 0) - 0.4f * p));
  const BakedColors baked = bake_adaptively(scene_of(mesh, {lamp({0.1f, 0, 0.3f}, {0.01f, 0.01f, 0.01f})}));
  EXPECT_FALSE(baked.certificate->is_certified);
  EXPECT_TRUE(std::isinf(baked.certificate->max_bound));
  ASSERT_FALSE(baked.findings.empty());
  EXPECT_EQ(baked.findings[0].code, "unbounded_triangles");
}

// Around a vertex without a normal the interpolated one turns by the same angles at every scale.
TEST(Adaptive, VertexWithoutANormal_IsNotCutForWithoutEnd) {
  Scene scene = scene_of(icosphere(1), {sun({0.4f, 1, 0.3f})});
  const std::size_t n_cut_for_all = bake_adaptively(scene).mesh->n_triangles();
  scene.mesh.normals[0] = glm::vec3(0);
  const BakedColors baked = bake_adaptively(scene);
  EXPECT_FALSE(baked.certificate->is_certified);
  EXPECT_LT(baked.mesh->n_triangles(), n_cut_for_all + 1000);  // some 150 for each of its five faces
  std::size_t n_told = 0;
  for (const Finding& finding : baked.findings)
    if (finding.code == "triangles_without_direction") n_told = finding.count;
  EXPECT_GT(n_told, 0U);
  EXPECT_EQ(n_told, baked.certificate->open_triangles);
}

// Two sides of such a triangle lie on the third: what is cut on one is never met by the other.
TEST(Adaptive, CornersInLine_HaveNoAreaAndNoError) {
  Mesh mesh;
  mesh.positions = {{0.25f, 0.5f, 0.75f}, {1, 2, 3}, {0.75f, 1.5f, 2.25f}};
  mesh.normals = {glm::normalize(glm::vec3(1, 1, 0)), glm::normalize(glm::vec3(-1, 1, 0)), {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  const BakedColors baked = bake_adaptively(scene_of(mesh, {sun({1, 0.2f, 0})}));
  EXPECT_TRUE(baked.certificate->is_certified);
  EXPECT_EQ(baked.mesh->n_triangles(), 1U);
}

TEST(Adaptive, DefectsOfTheMesh_DoNotBreakIt) {
  Mesh mesh = icosphere(1);
  const auto n = static_cast<std::uint32_t>(mesh.n_vertices());
  mesh.positions.push_back({NAN, 0, 0});
  mesh.positions.push_back({5, 5, 5});
  mesh.triangles.push_back({0, 1, n});
  mesh.triangles.push_back({0, 1, 1});
  mesh.triangles.push_back(mesh.triangles[0]);
  mesh.normals.clear();
  const BakedColors baked = bake_adaptively(scene_of(mesh, {sun({0.4f, 1, 0.3f})}));
  EXPECT_TRUE(baked.certificate->is_certified);
  EXPECT_FALSE(baked.cuts.empty());
  EXPECT_EQ(bake_adaptively(scene_of(Mesh{}, {sun({0, 1, 0})})).mesh->n_triangles(), 0U);
}

TEST(Adaptive, NoTolerance_IsRefused) {
  EXPECT_THROW(bake_adaptively(scene_of(icosphere(0), {}), 0), InvalidOption);
}

TEST(Adaptive, OneAndTwoThreads_GiveTheSameBytes) {
  const Scene scene = scene_of(icosphere(3), {sun({0.4f, 1, 0.3f}), lamp({1.2f, 0.5f, 0})});
  set_thread_count(1);
  const BakedColors one = bake_adaptively(scene);
  set_thread_count(0);
  const BakedColors all = bake_adaptively(scene);
  EXPECT_EQ(one.mesh->positions, all.mesh->positions);
  EXPECT_EQ(one.mesh->triangles, all.mesh->triangles);
  EXPECT_EQ(one.colors, all.colors);
}

}  // namespace
}  // namespace lambake
