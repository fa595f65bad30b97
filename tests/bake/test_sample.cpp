#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "lambake/bake/bake.h"
#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/geometry/normals.h"
#include "lambake/shading/lambert.h"
#include "shapes.h"

namespace lambake {
namespace {

constexpr double pi = std::numbers::pi;

Light sun(const glm::vec3& towards, const LinearRgb& intensity = {1, 1, 1}) {
  return {.intensity = intensity, .direction_to_light = glm::normalize(towards)};
}

Light lamp(const glm::vec3& position, const LinearRgb& intensity = {1, 1, 1}, float decay = 2) {
  Light light;
  light.type = LightType::point;
  light.intensity = intensity;
  light.position = position;
  light.decay = decay;
  return light;
}

Light spot(const glm::vec3& position, const glm::vec3& direction) {
  Light light = lamp(position, {3, 2, 1});
  light.type = LightType::spot;
  light.spot_direction = glm::normalize(direction);
  light.inner_cone_rad = 0.2f;
  light.outer_cone_rad = 0.9f;
  light.range = 6;
  return light;
}

/// One light of each kind, all outside of the unit sphere.
std::vector<Light> some_lights() {
  return {sun({0.4f, 1, 0.3f}, {0.5f, 0.4f, 0.3f}), lamp({1.5f, 0.5f, 1}, {1, 0, 2}, 1),
          spot({-1, 2, 1}, {1, -2, -1})};
}

Scene scene_of(Mesh mesh, std::vector<Light> lights) {
  Scene scene;
  if (mesh.normals.empty()) mesh.normals = vertex_normals(mesh, NormalWeight::angle).normals;
  scene.mesh = std::move(mesh);
  scene.materials.resize(1);
  scene.lights = std::move(lights);
  return scene;
}

std::vector<LinearRgb> baked(Mesh mesh, std::vector<Light> lights, BakeMethod method = BakeMethod::sample) {
  return bake(scene_of(std::move(mesh), std::move(lights)), {.method = method}).colors;
}

/// The same mesh, every vertex (and normal) moved by `move` (and `turn`).
template <typename Move, typename Turn>
Mesh moved(Mesh mesh, Move&& move, Turn&& turn) {
  for (glm::vec3& p : mesh.positions) p = move(p);
  for (glm::vec3& n : mesh.normals) n = turn(n);
  return mesh;
}

TEST(BakeSample, QuadUnderALamp_UnderestimatesItsMiddle) {
  // A square of half side a, a lamp at height h over its centre: 1/h² there, h/(2a² + h²)^(3/2) at the
  // corners, so the interpolated light is too low by 1 − (1 + 2(a/h)²)^(−3/2).
  const std::array<std::pair<double, double>, 3> known = {{{0.5, 0.456}, {1, 0.808}, {2, 0.963}}};
  for (const auto& [ratio, share] : known) {
    const Light light = lamp({0, 1, 0});
    const Mesh quad = grid(1, static_cast<float>(ratio));
    const std::vector<LinearRgb> colors = baked(quad, {light});
    const glm::uvec3& t = quad.triangles[0];  // Its side from corner 0 to 2 runs through the centre.
    ASSERT_EQ(quad.positions[t[0]] + quad.positions[t[2]], glm::vec3(0));
    const double vertex_light = (double(colors[t[0]].r) + double(colors[t[2]].r)) / 2;
    const double true_light = received<double>(light, glm::dvec3(0), glm::dvec3(0, 1, 0));
    const double missing = 1 - vertex_light / true_light;
    EXPECT_NEAR(missing, 1 - std::pow(1 + 2 * ratio * ratio, -1.5), 1e-6);
    EXPECT_NEAR(missing, share, 0.0005);  // As people quote it, rounded.
  }
}

TEST(BakeSample, NormalsSpreadAlongAnEdge_LoseTheMiddle) {
  // Two normals θ apart, the sun between them: cos(θ/2) at both ends, 1 in the middle.
  for (const double degrees : {10, 45, 90, 150}) {
    const double half = degrees * pi / 360;
    Mesh mesh;
    mesh.positions = {{-1, 0, 0}, {1, 0, 0}, {0, 0, -1}};
    mesh.triangles = {{0, 1, 2}};
    mesh.normals = {{-std::sin(half), std::cos(half), 0}, {std::sin(half), std::cos(half), 0}, {0, 1, 0}};
    const std::vector<LinearRgb> colors = baked(mesh, {sun({0, 1, 0})});
    const double middle = (double(colors[0].r) + double(colors[1].r)) / 2;
    EXPECT_NEAR(1 - middle, 1 - std::cos(half), 1e-6) << degrees;
  }
}

TEST(BakeSample, FlatSheetUnderASun_HasOneColour) {
  const std::vector<LinearRgb> colors = baked(grid(7, 2), {sun({0.3f, 1, -0.2f}, {1, 0.5f, 0.25f})});
  for (const LinearRgb& c : colors) EXPECT_EQ(c, colors.front());
  EXPECT_NEAR(colors.front().r, 1 / std::sqrt(1.13), 1e-6);
}

TEST(BakeSample, LightAddsUp) {
  const std::vector<Light> lights = some_lights();
  const std::vector<LinearRgb> all = baked(icosphere(3), lights);
  std::vector<LinearRgb> sum(all.size());
  for (const Light& light : lights) {
    const std::vector<LinearRgb> one = baked(icosphere(3), {light});
    for (std::size_t v = 0; v < sum.size(); ++v) sum[v] += one[v];
  }
  EXPECT_EQ(all, sum);  // The same additions in the same order.
}

TEST(BakeSample, NoLight_IsBlack) {
  for (const LinearRgb& c : baked(icosphere(1), {})) EXPECT_EQ(c, LinearRgb{});
}

TEST(BakeSample, RigidMotionOfMeshAndLights_ChangesNothing) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1, 2, -0.5));
  const auto turn = [&](const glm::vec3& v) {  // Rodrigues, by 1.1 rad
    const glm::dvec3 d(v);
    return glm::vec3(d * std::cos(1.1) + glm::cross(axis, d) * std::sin(1.1) +
                     axis * glm::dot(axis, d) * (1 - std::cos(1.1)));
  };
  const auto move = [&](const glm::vec3& p) { return turn(p) + glm::vec3(3, -2, 1); };
  std::vector<Light> lights = some_lights();
  const std::vector<LinearRgb> before = baked(icosphere(3), lights);
  for (Light& light : lights) {
    light.direction_to_light = turn(light.direction_to_light);
    light.position = move(light.position);
    light.spot_direction = turn(light.spot_direction);
  }
  const std::vector<LinearRgb> after = baked(moved(icosphere(3), move, turn), lights);
  for (std::size_t v = 0; v < before.size(); ++v) {
    // Positions up to 5 are rounded to 2.4e-7; the steepest light (the spot's ramp, intensity 3) magnifies
    // it.
    EXPECT_NEAR(before[v].r, after[v].r, 5e-6);
    EXPECT_NEAR(before[v].b, after[v].b, 5e-6);
  }
}

TEST(BakeSample, MirroredTwin_BakesTheSameBits) {
  const auto mirror = [](const glm::vec3& v) { return glm::vec3(-v.x, v.y, v.z); };
  Mesh twin = moved(height_field(16), mirror, mirror);
  for (glm::uvec3& t : twin.triangles) std::swap(t.y, t.z);
  std::vector<Light> lights = some_lights(), mirrored = lights;
  for (Light& light : mirrored) {
    light.direction_to_light = mirror(light.direction_to_light);
    light.position = mirror(light.position);
    light.spot_direction = mirror(light.spot_direction);
  }
  EXPECT_EQ(baked(twin, mirrored), baked(height_field(16), lights));
}

TEST(BakeSample, SceneTwiceAsBig_NeedsFourTimesTheLight_ToTheBit) {
  const auto twice = [](const glm::vec3& v) { return 2.0f * v; };
  const Mesh small = height_field(16);
  const Mesh big = moved(small, twice, [](const glm::vec3& n) { return n; });
  EXPECT_EQ(baked(big, {lamp({1, 2, 0}, {4, 4, 4})}), baked(small, {lamp({0.5f, 1, 0}, {1, 1, 1})}));
}

TEST(BakeSample, BaseColour_MultipliesLight) {
  Mesh mesh = icosphere(2);
  const std::vector<LinearRgb> white = baked(mesh, some_lights());
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v)
    mesh.colors.push_back({0.5f, 0.25f, static_cast<float>(v % 2)});
  const std::vector<LinearRgb> colored = baked(mesh, some_lights());
  for (std::size_t v = 0; v < white.size(); ++v) EXPECT_EQ(colored[v], white[v] * mesh.colors[v]);
}

TEST(BakeSample, UnlitMaterial_ShowsItsBaseColour) {
  Scene scene = scene_of(cube(0), some_lights());
  const std::vector<LinearRgb> lit = bake(scene, {}).colors;
  scene.materials.resize(2);
  scene.materials[1].is_unlit = true;
  scene.mesh.materials.assign(12, 0);
  scene.mesh.materials[0] = 1;
  scene.mesh.colors.assign(8, {0.1f, 0.2f, 0.3f});
  const std::vector<LinearRgb> colors = bake(scene, {}).colors;
  const glm::uvec3& unlit = scene.mesh.triangles[0];
  for (std::uint32_t v = 0; v < 8; ++v) {
    const bool is_unlit = v == unlit.x || v == unlit.y || v == unlit.z;
    EXPECT_EQ(colors[v], is_unlit ? scene.mesh.colors[v] : lit[v] * scene.mesh.colors[v]);
  }
}

TEST(BakeSample, VerticesWithoutADirectionOrAPosition_AreBlackUnderLamps_NeverNaN) {
  Mesh mesh = icosphere(1);
  mesh.normals = mesh.positions;
  mesh.normals[3] = glm::vec3(0);
  mesh.positions[4].x = std::numeric_limits<float>::quiet_NaN();
  mesh.positions[5].y = std::numeric_limits<float>::infinity();
  const std::vector<LinearRgb> colors = baked(mesh, {lamp({2, 3, 4}), lamp({-3, -2, 1}, {1, 1, 1}, 0.5f)});
  for (const std::size_t v : {3U, 4U, 5U}) EXPECT_EQ(colors[v], LinearRgb{}) << v;
  for (const LinearRgb& c : colors) EXPECT_TRUE(is_finite(c));
}

TEST(BakeSample, WithoutNormals_IsRefused) {
  Scene scene = scene_of(cube(0), {});
  scene.mesh.normals.clear();
  EXPECT_THROW(bake(scene, {}), InvalidScene);
}

TEST(BakeSample, EmptyMesh_HasNoColours) {
  EXPECT_TRUE(baked({}, some_lights()).empty());
  EXPECT_TRUE(baked({}, some_lights(), BakeMethod::face).empty());
}

TEST(BakeFace, EachTriangleHasItsOwnColour_ThatOfItsCentroid) {
  const Scene scene = scene_of(icosphere(2), some_lights());
  const BakedColors result = bake(scene, {.method = BakeMethod::face});
  const Mesh& mesh = mesh_of(scene, result);
  const std::vector<glm::vec3> normals = face_normals(scene.mesh);
  ASSERT_EQ(result.colors.size(), 3 * scene.mesh.n_triangles());
  ASSERT_NO_THROW(check_mesh(mesh, 1));
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    const glm::uvec3 &t = mesh.triangles[f], &source = scene.mesh.triangles[f];
    glm::vec3 centroid(0);
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(mesh.positions[t[c]], scene.mesh.positions[source[c]]);
      EXPECT_EQ(mesh.source_vertex_of(t[c]), source[c]);
      EXPECT_EQ(result.colors[t[c]], result.colors[t[0]]);
      centroid += scene.mesh.positions[source[c]] / 3.0f;
    }
    const glm::vec3 e = irradiance<float>(scene.lights, centroid, normals[f]);
    // The centroid is rounded differently here.
    EXPECT_NEAR(result.colors[t[0]].r, e.r, 5e-6);
    EXPECT_NEAR(result.colors[t[0]].b, e.b, 5e-6);
  }
}

TEST(BakeFace, FaceWithoutArea_IsBlack) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 0, 1}};
  for (const LinearRgb& c : baked(mesh, some_lights(), BakeMethod::face)) EXPECT_EQ(c, LinearRgb{});
}

/// 600 dim lamps over a floor of 41 × 41 vertices.
Scene floor_under_many_lamps() {
  Scene scene;
  scene.materials.emplace_back();
  scene.mesh = grid(40, 1);
  scene.mesh.normals = vertex_normals(scene.mesh, NormalWeight::angle).normals;
  for (int i = 0; i < 600; ++i) {
    Light light;
    light.type = LightType::point;
    const float turn = 2.3999632f * static_cast<float>(i), r = 2 * std::sqrt(static_cast<float>(i) / 600);
    const float height = 0.2f + 0.3f * static_cast<float>(i % 7);
    light.position = {r * std::cos(turn), height, r * std::sin(turn)};
    light.intensity = {1e-6f, 2e-6f, 0};
    scene.lights.push_back(light);
  }
  return scene;
}

TEST(Bake, BaseColoursAboveOne_AreInTheErrorOfMergedLights) {
  for (const float base : {1.0f, 30.0f, 1000.0f})
    for (const BakeMethod method : {BakeMethod::sample, BakeMethod::face, BakeMethod::uniform}) {
      Scene scene = floor_under_many_lamps();
      scene.mesh.colors.assign(scene.mesh.n_vertices(), LinearRgb{base, base, base});
      BakeOptions options{.method = method, .light_tolerance = 0.02};
      const BakedColors merged = bake(scene, options);
      options.light_tolerance = 0;
      const BakedColors plain = bake(scene, options);
      ASSERT_GT(merged.light_error.display, 0);
      EXPECT_LE(merged.light_error.display, 0.02);
      for (std::size_t i = 0; i < merged.colors.size(); ++i) {
        const double m = merged.colors[i].g, p = plain.colors[i].g;
        EXPECT_LE(std::abs(m - p), merged.light_error.linear + 1e-5 * p) << base;
        EXPECT_LE(std::abs(srgb_encode(m) - srgb_encode(p)), merged.light_error.display + 1e-5) << base;
      }
    }
}

TEST(Bake, MergedLights_AreToldByNoLessThanTheirError) {
  Scene scene = floor_under_many_lamps();
  for (const double tolerance : {0.02, 0.011, 0.0047, 0.0013, 0.00098}) {
    const BakedColors merged = bake(scene, {.light_tolerance = tolerance});
    ASSERT_EQ(merged.findings.size(), 1U);
    const std::string& text = merged.findings[0].text;
    const std::size_t at = text.find("more than ");
    ASSERT_NE(at, std::string::npos) << text;
    EXPECT_GE(std::stod(text.substr(at + 10)) * (1 + 1e-8), 255 * merged.light_error.display) << text;
  }
}

TEST(Bake, OneOrTwoThreads_SameBits) {
  for (const BakeMethod method : {BakeMethod::sample, BakeMethod::face}) {
    set_thread_count(1);
    const std::vector<LinearRgb> one = baked(icosphere(5), some_lights(), method);
    set_thread_count(2);
    const std::vector<LinearRgb> two = baked(icosphere(5), some_lights(), method);
    set_thread_count(0);
    EXPECT_EQ(one, two);
  }
}

}  // namespace
}  // namespace lambake
