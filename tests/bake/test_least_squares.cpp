#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "lambake/bake/bake.h"
#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/measure/surface_error.h"
#include "measure/scenes.h"

namespace lambake {
namespace {

BakedColors least_squares(const Scene& scene, double gradient_weight = 0) {
  return bake(scene, {.method = BakeMethod::least_squares, .gradient_weight = gradient_weight});
}

double rmse(const Scene& scene, const BakedColors& baked) {
  return surface_error(scene, baked, ErrorSpace::linear).rmse;
}

TEST(LeastSquares, SphereAndPlane_HaveAFractionOfTheErrorOfSampling) {
  const auto gain = [](const Scene& scene) {
    return rmse(scene, bake(scene, {})) / rmse(scene, bake(scene, {.method = BakeMethod::least_squares}));
  };
  // The least that colours which a file holds reach is 1 / 1.269, 1 / 1.969 and 1 / 2.217 of the error.
  EXPECT_GE(gain(scene_of(icosphere(3), {sun({0.4f, 1, 0.3f})})), 1.265);
  EXPECT_GE(gain(scene_of(icosphere(4), {lamp({0.5f, 1.25f, 0.375f}, {0.1f, 0.1f, 0.1f})})), 1.965);
  EXPECT_GE(gain(scene_of(grid(32, 1), {lamp({0, 0.25f, 0}, {0.05f, 0.05f, 0.05f})})), 2.21);
}

TEST(LeastSquares, LightThatIsLinear_IsFoundExactly) {
  const Scene scene = scene_of(grid(5, 1), {sun({0.4f, 1, 0.3f}, {0.9f, 0.5f, 0.2f})});
  const BakedColors sampled = bake(scene, {}), fitted = least_squares(scene, 0.1);
  for (std::size_t v = 0; v < sampled.colors.size(); ++v) {
    EXPECT_NEAR(fitted.colors[v].r, sampled.colors[v].r, 1e-6);
    EXPECT_NEAR(fitted.colors[v].b, sampled.colors[v].b, 1e-6);
  }
}

// A minimum: every small change of the colours makes it worse, as long as it leaves them between black and 1.
TEST(LeastSquares, AnyChangeOfTheColours_RaisesTheRmse) {
  std::mt19937 engine(5);
  for (const Scene& scene :
       {scene_of(grid(6, 1), {lamp({0.2f, 0.4f, 0.1f}, {0.1f, 0.2f, 0.1f})}),
        scene_of(icosphere(2), {sun({0.4f, 1, 0.3f}), sun({-1, 0.2f, 0.3f}, {0.3f, 0.1f, 0})})}) {
    const BakedColors best = least_squares(scene);
    const double least = rmse(scene, best);
    for (int trial = 0; trial < 20; ++trial) {
      BakedColors changed = best;
      for (LinearRgb& c : changed.colors) {
        const float change = 0.01f * (static_cast<float>(engine()) / 2147483648.0f - 1);
        c += {change, change, change};
        for (float* channel : {&c.r, &c.g, &c.b}) *channel = std::clamp(*channel, 0.0f, 1.0f);
      }
      EXPECT_GT(rmse(scene, changed), least);
    }
  }
}

struct Side {
  std::size_t triangle = 0;
  int corner = 0;
};

/// Σ min(A_1, A_2) h² (jump of the derivative of the green)² over the sides of just two triangles that wind
/// alike, by the definition.
double jumps(const Mesh& mesh, const std::vector<LinearRgb>& colors) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Side>> sides;
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f)
    for (int c = 0; c < 3; ++c)
      sides[std::minmax({mesh.triangles[f][c], mesh.triangles[f][(c + 1) % 3]})].push_back({f, c});
  double sum = 0;
  for (const auto& [ends, both] : sides) {
    if (both.size() != 2) continue;
    double derivative = 0, least_area = 1e9, least_height = 1e9;
    std::uint32_t first[2];
    for (int k = 0; k < 2; ++k) {
      const glm::uvec3& t = mesh.triangles[both[k].triangle];
      first[k] = t[both[k].corner];
      const auto corner = [&](int c) { return t[(both[k].corner + c) % 3]; };
      const auto position = [&](int c) { return glm::dvec3(mesh.positions[corner(c)]); };
      const auto color = [&](int c) { return double(colors[corner(c)].g); };
      // In the plane of the triangle: x along the side, y into the triangle.
      const glm::dvec3 x = glm::normalize(position(1) - position(0)), to_apex = position(2) - position(0);
      const double length = glm::length(position(1) - position(0)), along = glm::dot(to_apex, x),
                   height = glm::length(to_apex - along * x);
      const double slope_x = (color(1) - color(0)) / length;
      derivative += (color(2) - color(0) - slope_x * along) / height;
      const double area = 0.5 * length * height;
      least_area = std::min(least_area, area);
      for (int c = 0; c < 3; ++c)
        least_height = std::min(least_height, 2 * area / glm::length(position((c + 1) % 3) - position(c)));
    }
    if (first[0] == first[1]) continue;  // They wind against each other.
    sum += least_area * least_height * least_height * derivative * derivative;
  }
  return sum;
}

double area(const Mesh& mesh) {
  double sum = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 p = mesh.positions[t.x];
    sum += 0.5 *
           glm::length(glm::cross(glm::dvec3(mesh.positions[t.y]) - p, glm::dvec3(mesh.positions[t.z]) - p));
  }
  return sum;
}

// Of the whole functional, on a surface with a fin, a face turned round and a hole.
TEST(LeastSquares, AnyChangeOfTheColours_RaisesTheSumWithTheJumps) {
  Mesh mesh = icosphere(2);
  const auto fin = static_cast<std::uint32_t>(mesh.n_vertices());
  mesh.positions.push_back(2.0f * mesh.positions[0]);
  mesh.triangles.push_back({mesh.triangles[0].x, mesh.triangles[0].y, fin});
  std::swap(mesh.triangles[40].x, mesh.triangles[40].y);
  mesh.triangles.erase(mesh.triangles.begin() + 100);
  const Scene scene =
      scene_of(mesh, {sun({0.4f, 1, 0.3f}, {0.4f, 0.4f, 0.4f}), sun({0, -1, 0}, {0.2f, 0.2f, 0.2f})});
  for (const double weight : {0.003, 0.1, 3.0}) {
    const auto functional = [&](const BakedColors& baked) {
      return std::pow(rmse(scene, baked), 2) * area(mesh) + weight * jumps(mesh, baked.colors);
    };
    const BakedColors best = least_squares(scene, weight);
    const double least = functional(best);
    EXPECT_GT(jumps(mesh, best.colors), 0);
    std::mt19937 engine(3);
    // Along each of the colours alone, as far as they may go, and along all.
    for (std::size_t v = 0; v <= best.colors.size(); ++v)
      for (const float size : {-0.002f, 0.002f}) {
        BakedColors changed = best;
        for (std::size_t i = 0; i < changed.colors.size(); ++i) {
          const float change = v == i                   ? size
                               : v < best.colors.size() ? 0
                                                        : size * static_cast<float>(engine() % 100) / 100;
          const float g = std::clamp(changed.colors[i].g + change, 0.0f, 1.0f);
          changed.colors[i] = {g, g, g};
        }
        EXPECT_GE(functional(changed), least) << weight << ", vertex " << v;
      }
  }
}

TEST(LeastSquares, MoreGradientWeight_CostsRmse) {
  const Scene scene = scene_of(icosphere(2), {sun({0.4f, 1, 0.3f})});
  double previous = 0;
  for (const double weight : {0.0, 0.1, 1.0, 10.0}) {
    const double now = rmse(scene, least_squares(scene, weight));
    EXPECT_GT(now, previous);
    previous = now;
  }
}

// Only linear functions have no jumps of their slope on a plane.
TEST(LeastSquares, HugeGradientWeight_LeavesALinearFunction) {
  constexpr int n = 6;
  const Scene scene = scene_of(grid(n, 1), {lamp({0.2f, 0.4f, 0.1f}, {0.1f, 0.2f, 0.1f})});
  const auto largest_bend = [&](double weight) {
    const std::vector<LinearRgb> colors = least_squares(scene, weight).colors;
    float largest = 0;
    for (std::size_t v = 0; v < colors.size(); ++v) {
      const std::size_t row = v / (n + 1), column = v % (n + 1);
      if (column > 0 && column < n)
        largest = std::max(largest, std::abs(colors[v - 1].g - 2 * colors[v].g + colors[v + 1].g));
      if (row > 0 && row < n)
        largest = std::max(largest, std::abs(colors[v - n - 1].g - 2 * colors[v].g + colors[v + n + 1].g));
    }
    return largest;
  };
  EXPECT_GT(largest_bend(0), 0.1f);
  EXPECT_LT(largest_bend(10), 0.1f * largest_bend(0));
  EXPECT_LT(largest_bend(100), 0.3f * largest_bend(10));
}

/// 300 × 300 vertices, more than 16 bits can tell apart, and a hub above of many triangles, without a normal.
Scene fine_floor_with_hub() {
  Scene scene = scene_of(grid(299, 1), {lamp({0.2f, 0.4f, 0.1f}, {0.1f, 0.2f, 0.1f}),
                                        lamp({0.6f, 0.01f, -0.3f}, {1e-4f, 0, 0})});
  Mesh& mesh = scene.mesh;
  const auto hub = static_cast<std::uint32_t>(mesh.n_vertices());
  mesh.positions.push_back({0, 1.5f, 0});
  mesh.normals.push_back({0, 0, 0});
  std::vector<glm::uvec3> fan;
  for (std::uint32_t v = 0; v + 1 < hub; v += 97) fan.push_back({hub, v, v + 1});
  mesh.triangles.insert(mesh.triangles.begin(), fan.begin(), fan.end());
  return scene;
}

void shuffle(std::vector<glm::uvec3>& triangles) {
  std::mt19937 engine(2);
  for (std::size_t i = triangles.size(); i > 1; --i) std::swap(triangles[i - 1], triangles[engine() % i]);
}

TEST(LeastSquares, OrderOfTheTriangles_IsNoMatter) {
  Scene scene = fine_floor_with_hub();
  const std::vector<LinearRgb> ordered = least_squares(scene, 0.003).colors;
  shuffle(scene.mesh.triangles);
  const std::vector<LinearRgb> shuffled = least_squares(scene, 0.003).colors;
  float largest = 0;
  for (std::size_t v = 0; v < ordered.size(); ++v)
    largest =
        std::max({largest, std::abs(ordered[v].r - shuffled[v].r), std::abs(ordered[v].g - shuffled[v].g)});
  EXPECT_LT(largest, 2e-6f);
}

// More than one block of rows, rows that reach far, and one long row.
TEST(LeastSquares, OneOrTwoThreads_SameBits) {
  Scene scene = fine_floor_with_hub();
  for (const bool is_ordered : {true, false}) {
    if (!is_ordered) shuffle(scene.mesh.triangles);
    set_thread_count(1);
    const std::vector<LinearRgb> one = least_squares(scene, 0.003).colors;
    set_thread_count(2);
    const std::vector<LinearRgb> two = least_squares(scene, 0.003).colors;
    set_thread_count(0);
    EXPECT_EQ(one, two);
  }
}

TEST(LeastSquares, CopiesAtASeam_KeepOneColour) {
  Scene scene = scene_of(icosphere(1), {sun({0.4f, 1, 0.3f})});
  const std::uint32_t copy = append_vertex_copy(scene.mesh, 0);
  int n_uses = 0;  // every second triangle around it takes the copy
  for (glm::uvec3& t : scene.mesh.triangles)
    for (int c = 0; c < 3; ++c)
      if (t[c] == 0 && ++n_uses % 2 == 0) t[c] = copy;
  const BakedColors baked = least_squares(scene, 0.05);
  EXPECT_EQ(baked.colors[0], baked.colors[copy]);
  const BakedColors whole = least_squares(scene_of(icosphere(1), {sun({0.4f, 1, 0.3f})}), 0.05);
  for (std::size_t v = 0; v < whole.colors.size(); ++v)
    EXPECT_NEAR(baked.colors[v].g, whole.colors[v].g, 1e-6) << v;
}

TEST(LeastSquares, ColoursThatAFileHolds_StayWithinIt) {
  for (const float strength : {1.0f, 2.0f}) {
    const Scene scene = scene_of(icosphere(2), {sun({0.4f, 1, 0.3f}, {strength, strength, 0.5f})});
    const BakedColors sampled = bake(scene, {}), fitted = least_squares(scene);
    std::size_t n_above = 0;
    for (std::size_t v = 0; v < fitted.colors.size(); ++v) {
      EXPECT_GE(fitted.colors[v].r, 0);
      EXPECT_LE(fitted.colors[v].b, 1);
      if (sampled.colors[v].r <= 1) {
        EXPECT_LE(fitted.colors[v].r, 1) << strength;
      }
      n_above += fitted.colors[v].r > 1;
    }
    EXPECT_EQ(n_above > 0, strength > 1);
    EXPECT_TRUE(fitted.findings.empty());
  }
}

// Sampled colours are among those that it chooses from.
TEST(LeastSquares, WithoutAGradientWeight_IsNeverWorseThanSampling) {
  std::mt19937 engine(7);
  const auto random = [&] { return static_cast<float>(engine()) / 2147483648.0f - 1; };
  for (int trial = 0; trial < 40; ++trial) {
    Mesh mesh = icosphere(2);
    // Crumpled: slivers, folds, and normals that differ much from corner to corner.
    for (glm::vec3& p : mesh.positions) p *= glm::vec3(1 + 0.3f * random(), 1, 0.02f + 0.02f * random());
    const Scene scene = scene_of(mesh, {sun({random(), random(), random()}, {0.6f, 0.3f, 0.9f}),
                                        lamp({2 * random(), 2 * random(), random()}, {0.3f, 0.1f, 0.2f})});
    EXPECT_LE(rmse(scene, least_squares(scene)), rmse(scene, bake(scene, {})) * (1 + 1e-6)) << trial;
  }
}

// On few triangles, with peaks and cones that a rule of seven places misses.
TEST(LeastSquares, NarrowLight_IsNeverWorseThanSampling) {
  std::mt19937 engine(11);
  const auto random = [&] { return static_cast<float>(engine()) / 2147483648.0f - 1; };
  std::size_t n_better = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const float height = 0.02f + 0.4f * std::abs(random());
    Light light = lamp({random(), height, random()}, {0.8f * height * height, 0.3f * height * height, 0});
    if (trial % 2 == 0) {
      light.type = LightType::spot;
      light.spot_direction = glm::normalize(glm::vec3(0.3f * random(), -1, 0.3f * random()));
      light.outer_cone_rad = 0.05f + 0.5f * std::abs(random());
      light.inner_cone_rad = 0.5f * light.outer_cone_rad;
    }
    const Scene scene = scene_of(grid(2, 2), {light});
    const double fitted = rmse(scene, least_squares(scene)), sampled = rmse(scene, bake(scene, {}));
    EXPECT_LE(fitted, sampled * 1.001) << trial;
    n_better += fitted < 0.98 * sampled;
  }
  EXPECT_GT(n_better, 10U);
}

// What is solved of one thing does not stop short because of another, however much larger it is.
TEST(LeastSquares, HugeGround_LeavesTheColoursOfASmallSphere) {
  const Mesh sphere = icosphere(3);
  const std::vector<Light> lights{sun({0.3f, 1, 0.2f}), lamp({2, 3, 1}, {0.5f, 1, 2})};
  const BakedColors alone = least_squares(scene_of(sphere, lights), 0.003);
  for (const float half_side : {100.0f, 1e5f}) {
    Mesh mesh = sphere;
    const auto first = static_cast<std::uint32_t>(mesh.n_vertices());
    const Mesh ground = grid(1, half_side);
    for (const glm::vec3& p : ground.positions) mesh.positions.push_back(p + glm::vec3(0, -1, 0));
    for (const glm::uvec3& t : ground.triangles) mesh.triangles.push_back(t + first);
    const BakedColors both = least_squares(scene_of(mesh, lights), 0.003);
    float largest = 0;
    for (std::size_t v = 0; v < first; ++v)
      largest = std::max(largest, std::abs(both.colors[v].g - alone.colors[v].g));
    EXPECT_LT(largest, 2e-6f) << half_side;
  }
}

/// A disc around a corner, of two rings, cut into sectors whose widths span `decades` powers of ten.
Mesh disc_of_sectors(double decades) {
  constexpr std::uint32_t n = 400;
  std::mt19937 engine(1);
  std::vector<double> begins{0};
  for (std::uint32_t i = 0; i < n; ++i)
    begins.push_back(begins.back() + std::pow(10, -decades * static_cast<double>(engine()) / 4294967296.0));
  Mesh mesh;
  mesh.positions.emplace_back(0.0f, 0.5f, 0.0f);
  for (const auto& [radius, height] : {std::pair{1.0, 0.2}, std::pair{1.2, 0.0}})
    for (std::uint32_t i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * begins[i] / begins.back();
      mesh.positions.emplace_back(radius * std::cos(angle), height, -radius * std::sin(angle));
    }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 1 + i, b = 1 + (i + 1) % n;
    mesh.triangles.insert(mesh.triangles.end(), {{0, a, b}, {a, a + n, b + n}, {a, b + n, b}});
  }
  return mesh;
}

std::size_t n_unsettled(const Scene& scene, double gradient_weight) {
  for (const Finding& finding : least_squares(scene, gradient_weight).findings)
    if (finding.code == "least_squares_unsettled") return finding.count;
  return 0;
}

// The jumps are weighed by the least height of a triangle, so that they count no more between slivers.
TEST(LeastSquares, AnySlivers_ReachTheEnd_AndGainAsMuch) {
  for (const double decades : {0.0, 1.0, 4.0, 8.0}) {
    const Scene scene = scene_of(disc_of_sectors(decades), {lamp({0.5f, 1, 0.5f})});
    for (const double weight : {0.0, 0.003, 0.1, 1.0}) EXPECT_EQ(n_unsettled(scene, weight), 0U) << decades;
    const double least = rmse(scene, least_squares(scene)),
                 weighed = rmse(scene, least_squares(scene, 0.003));
    EXPECT_LT(least, 0.9 * rmse(scene, bake(scene, {}))) << decades;
    EXPECT_LT(weighed, 1.01 * least) << decades;
  }
}

// Where only the sun reaches its light is left, however bright a lamp is elsewhere.
TEST(LeastSquares, SpotThatIsBrighterByPowersOfTen_LeavesTheOtherColours) {
  for (const double decay : {2.0, 4.0, 8.0}) {
    Light bright = lamp({0.5083333f, 1e-5f, -0.5166667f}, {1e4f, 1e4f, 1e4f}, static_cast<float>(decay));
    bright.range = 0.2f;
    const Scene scene = scene_of(grid(30, 1), {bright, sun({0, 1, 0}, {0.5f, 0.4f, 0.1f})});
    const BakedColors baked = least_squares(scene, 0.003);
    EXPECT_TRUE(baked.findings.empty());
    for (std::size_t v = 0; v < baked.colors.size(); ++v) {
      const glm::vec3& p = scene.mesh.positions[v];
      if (std::hypot(p.x - bright.position.x, p.z - bright.position.z) < 0.6f) continue;
      EXPECT_NEAR(baked.colors[v].r, 0.5f, 0.02f);
      EXPECT_NEAR(baked.colors[v].b, 0.1f, 0.02f);
    }
  }
}

// A black face next to a white one must not draw the colours that they share away from the white one's light.
TEST(LeastSquares, MaterialsThatShareVertices_CountByTheirBaseColours) {
  Mesh mesh = icosphere(2);
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) mesh.materials.push_back(f % 2);
  Scene scene = scene_of(mesh, {sun({0.4f, 1, 0.3f}, {0.9f, 0.9f, 0.9f})});
  scene.materials.resize(2);
  const double alike = rmse(scene, least_squares(scene));
  scene.materials[1].base_color = {0.02f, 0.02f, 0.02f};
  const double sampled = rmse(scene, bake(scene, {})), fitted = rmse(scene, least_squares(scene));
  EXPECT_LT(fitted, 0.93 * alike / std::sqrt(2.0));
  EXPECT_LT(fitted, 0.72 * sampled);
}

// The light of such a triangle is no polynomial of low degree.
TEST(LeastSquares, NormalsFarApart_AreNeverWorseThanSampling) {
  std::mt19937 engine(3);
  const auto random = [&] { return static_cast<float>(engine()) / 2147483648.0f - 1; };
  for (int trial = 0; trial < 600; ++trial) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}};
    mesh.triangles = {{0, 1, 2}};
    for (int i = 0; i < 3; ++i)
      mesh.normals.push_back(glm::normalize(glm::vec3(random(), random(), random())));
    const Scene scene = scene_of(mesh, {sun({random(), random(), random()}, {0.9f, 0.5f, 0.2f})});
    const double fitted = rmse(scene, least_squares(scene)), sampled = rmse(scene, bake(scene, {}));
    EXPECT_LE(fitted, 1.0003 * sampled) << trial;
  }
}

// Thousands of triangles around one vertex.
TEST(LeastSquares, ConstantLightOnAFan_IsFoundExactly) {
  constexpr std::uint32_t n = 4096;
  Mesh mesh;
  mesh.positions.emplace_back(0.0f);
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    mesh.positions.emplace_back(std::cos(angle), 0, -std::sin(angle));
    mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
  }
  for (const bool is_last : {false, true}) {
    if (is_last) std::rotate(mesh.triangles.begin(), mesh.triangles.begin() + 1, mesh.triangles.end());
    for (const double weight : {0.0, 0.003})
      for (const LinearRgb& c :
           least_squares(scene_of(mesh, {sun({0, 1, 0}, {0.55f, 0.3f, 0.1f})}), weight).colors) {
        EXPECT_NEAR(c.r, 0.55, 1e-6);
        EXPECT_NEAR(c.b, 0.1, 1e-6);
      }
  }
}

TEST(LeastSquares, TrianglesOfAnySize_GetTheirLight) {
  Mesh mesh = grid(4, 1);
  const auto n = static_cast<std::uint32_t>(mesh.n_vertices());
  for (glm::vec3& p : mesh.positions) p *= 1e-6f;
  mesh.positions.insert(mesh.positions.end(), {{0, -1, 0}, {1e20f, -1, 0}, {0, -1, -1e20f}});
  mesh.triangles.push_back({n, n + 1, n + 2});
  mesh.normals.assign(mesh.n_vertices(), {0, 1, 0});
  for (const LinearRgb& c : least_squares(scene_of(mesh, {sun({0, 1, 0}, {0.5f, 0.5f, 0.5f})}), 0.003).colors)
    EXPECT_NEAR(c.g, 0.5, 1e-6);
}

TEST(LeastSquares, NothingThatIsLit_KeepsTheSamples) {
  Scene scene = scene_of(icosphere(1), {sun({0.4f, 1, 0.3f})});
  scene.materials[0].is_unlit = true;
  EXPECT_EQ(least_squares(scene, 0.003).colors, bake(scene, {}).colors);
}

TEST(LeastSquares, DefectsAndUnlitFaces_DoNotBreakIt) {
  Mesh mesh = icosphere(1);
  const auto n = static_cast<std::uint32_t>(mesh.n_vertices());
  mesh.positions.push_back({NAN, 0, 0});
  mesh.positions.push_back({5, 5, 5});
  mesh.triangles.push_back({0, 1, n});
  mesh.triangles.push_back({0, 1, 1});
  mesh.triangles.push_back({0, 1, n + 1});
  mesh.triangles.push_back({2, 1, n + 1});
  Scene scene = scene_of(mesh, {sun({0.4f, 1, 0.3f}), lamp({1, 1.5f, 0})});
  scene.materials.resize(2);
  scene.materials[1].is_unlit = true;
  scene.mesh.materials.assign(scene.mesh.n_triangles(), 0);
  scene.mesh.materials[3] = 1;
  for (const BakeMethod method : {BakeMethod::least_squares, BakeMethod::average}) {
    const BakedColors baked = bake(scene, {.method = method, .gradient_weight = 0.1});
    for (const LinearRgb& c : baked.colors) EXPECT_TRUE(is_finite(c));
    EXPECT_TRUE(std::isfinite(rmse(scene, baked)));
  }
  EXPECT_TRUE(least_squares(scene_of(Mesh{}, {sun({0, 1, 0})})).colors.empty());
  EXPECT_THROW(least_squares(scene, -1), InvalidOption);
  EXPECT_THROW(least_squares(scene, 101), InvalidOption);
}

TEST(Average, SphereUnderASun_IsWorseThanSampling) {
  const Scene scene = scene_of(icosphere(3), {sun({0.4f, 1, 0.3f})});
  EXPECT_GT(rmse(scene, bake(scene, {.method = BakeMethod::average})), rmse(scene, bake(scene, {})));
}

TEST(Average, FlatGridUnderASun_IsTheLight) {
  const Scene scene = scene_of(grid(3, 1), {sun({0, 1, 0}, {0.5f, 0.25f, 1})});
  for (const LinearRgb& c : bake(scene, {.method = BakeMethod::average}).colors)
    EXPECT_EQ(c, (LinearRgb{0.5f, 0.25f, 1}));
}

TEST(Uniform, EachLevel_QuartersTheTrianglesAndTheErrorOfSmoothLight) {
  const Scene scene = scene_of(grid(4, 1), {lamp({0.1f, 0.7f, 0.2f}, {0.3f, 0.3f, 0.3f})});
  double previous = 0;
  for (int level = 0; level <= 3; ++level) {
    const BakedColors baked = bake(scene, {.method = BakeMethod::uniform, .levels = level});
    EXPECT_EQ(baked.mesh->n_triangles(), scene.mesh.n_triangles() << (2 * level));
    EXPECT_EQ(baked.mesh->n_vertices(), static_cast<std::size_t>((4 << level) + 1) * ((4U << level) + 1));
    const double error = rmse(scene, baked);
    if (level > 1) {
      EXPECT_NEAR(previous / error, 4, 0.5);
    }
    previous = error;
  }
  EXPECT_THROW(bake(scene, {.method = BakeMethod::uniform, .levels = 14}), InvalidOption);
}

}  // namespace
}  // namespace lambake
