#include "lambake/measure/surface_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/measure/bound.h"
#include "lambake/shading/lambert.h"
#include "lambake/shading/texture.h"
#include "scenes.h"

namespace lambake {
namespace {

double on_screen(double linear) {
  return srgb_encode(std::clamp(linear, 0.0, 1.0));
}

struct Truth {
  double rmse = 0, mae = 0, mean = 0, max = 0;
};

/// The same integrals by brute force: the middles of n² equal parts of every triangle, the equation straight
/// from lambert.h.
Truth brute_force(const Scene& scene, const BakedColors& baked, ErrorSpace space, int n) {
  const Mesh& mesh = scene.mesh;
  double area = 0, square = 0, absolute = 0, plain = 0;
  Truth truth;
  const auto base_color = [&](const glm::uvec3& t, const glm::dvec3& b) {
    if (scene.textures.empty()) return glm::dvec3(1);
    glm::dvec2 uv(0);
    for (int c = 0; c < 3; ++c) uv += b[c] * glm::dvec2(mesh.texcoords[0][t[c]]);
    return glm::dvec3(sample_texture(scene, scene.textures[0], glm::vec2(uv)));
  };
  for (const glm::uvec3& t : mesh.triangles) {
    glm::dmat3 p, normal, color, albedo(1, 1, 1, 1, 1, 1, 1, 1, 1);
    for (int c = 0; c < 3; ++c) {
      p[c] = mesh.positions[t[c]];
      normal[c] = mesh.normals[t[c]];
      const LinearRgb& baked_color = baked.colors[t[c]];
      color[c] = {baked_color.r, baked_color.g, baked_color.b};
      if (!mesh.colors.empty()) albedo[c] = {mesh.colors[t[c]].r, mesh.colors[t[c]].g, mesh.colors[t[c]].b};
    }
    const double triangle_area = 0.5 * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
    area += triangle_area;
    const double weight = triangle_area / (3.0 * n * n);
    const auto visit = [&](double i, double j) {
      const glm::dvec3 b(1 - (i + j) / n, i / n, j / n);
      const glm::dvec3 base = base_color(t, b);
      const glm::dvec3 f =
          base * (albedo * b) * irradiance<double>(scene.lights, p * b, glm::normalize(normal * b));
      for (int c = 0; c < 3; ++c) {
        const double g = base[c] * (color * b)[c];
        const double e = space == ErrorSpace::linear ? g - f[c] : on_screen(g) - on_screen(f[c]);
        square += weight * e * e, absolute += weight * std::abs(e), plain += weight * e;
        truth.max = std::max(truth.max, std::abs(e));
      }
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        visit(i + 1.0 / 3, j + 1.0 / 3);
        if (i + j + 2 <= n) visit(i + 2.0 / 3, j + 2.0 / 3);
      }
  }
  truth.rmse = std::sqrt(square / area), truth.mae = absolute / area, truth.mean = plain / area;
  return truth;
}

TEST(SurfaceError, SmallScenes_AgreeWithBruteForceInBothSpaces) {
  for (const NamedScene& s : small_scenes())
    for (const ErrorSpace space : {ErrorSpace::linear, ErrorSpace::display}) {
      SCOPED_TRACE(s.name + (space == ErrorSpace::linear ? ", linear" : ", display"));
      const BakedColors baked = bake(s.scene, {.method = BakeMethod::sample});
      const int n = static_cast<int>(700 / std::sqrt(static_cast<double>(s.scene.mesh.n_triangles())));
      const Truth truth = brute_force(s.scene, baked, space, std::max(32, n));
      const SurfaceError error = surface_error(s.scene, baked, space);
      EXPECT_GT(truth.rmse, 1e-4);
      // Brute force itself is good to about 3e-4 across a kink.
      EXPECT_NEAR(error.rmse, truth.rmse, 1e-3 * truth.rmse);
      EXPECT_NEAR(error.mae, truth.mae, 5e-3 * truth.mae);
      EXPECT_NEAR(error.mean, truth.mean, 5e-3 * truth.mae);
      EXPECT_GE(error.max_sampled, truth.max * 0.999);
      EXPECT_LE(error.max_sampled, truth.max * 1.05);
    }
}

TEST(SurfaceError, NoisyTexture_AgreesWithBruteForceInBothSpaces) {
  Scene scene = scene_of(grid(10, 1), {lamp({0.2f, 0.4f, 0.1f}, {0.2f, 0.2f, 0.2f})});
  scene.mesh.texcoords[0].clear();
  for (const glm::vec3& p : scene.mesh.positions) scene.mesh.texcoords[0].emplace_back(p.x, p.z);
  Image image{32, 32, {}};
  std::uint32_t state = 1;
  const auto noise = [&state] {
    return static_cast<float>((state = state * 1664525U + 1013904223U) >> 8) * 0x1p-24f;
  };
  for (int i = 0; i < 32 * 32; ++i) image.pixels.emplace_back(noise(), noise(), noise(), 1.0f);
  scene.images.push_back(image);
  scene.textures.emplace_back();
  scene.materials[0].base_color_texture = 0;
  const BakedColors baked = bake(scene, {});
  for (const ErrorSpace space : {ErrorSpace::linear, ErrorSpace::display}) {
    const Truth truth = brute_force(scene, baked, space, 64);
    const SurfaceError error = surface_error(scene, baked, space);
    EXPECT_NEAR(error.rmse, truth.rmse, 1e-3 * truth.rmse);
    EXPECT_NEAR(error.mae, truth.mae, 5e-3 * truth.mae);
    EXPECT_NEAR(error.mean, truth.mean, 5e-3 * truth.mae);
    EXPECT_GE(error.max_sampled, truth.max * 0.99);
    EXPECT_LE(error.max_sampled, surface_bound(scene, baked, {.space = space}).max_bound);
  }
}

TEST(SurfaceError, TextureThatIsBlackButForASpot_AgreesWithBruteForceOnTwoTriangles) {
  Scene scene = scene_of(grid(1, 1), {sun({0.2f, 1, 0.1f}), lamp({0.5f, 3, -0.5f})});
  scene.mesh.texcoords[0].clear();
  for (const glm::vec3& p : scene.mesh.positions)
    scene.mesh.texcoords[0].emplace_back(0.5f + p.x / 2, 0.5f + p.z / 2);
  Image image{64, 64, {}};
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      image.pixels.emplace_back(glm::vec3(x >= 12 && x < 20 && y >= 37 && y < 45 ? 1 : 0), 1.0f);
  scene.images.push_back(image);
  scene.textures.emplace_back();
  scene.materials[0].base_color_texture = 0;
  const BakedColors baked = bake(scene, {});
  const Truth truth = brute_force(scene, baked, ErrorSpace::linear, 1000);
  const SurfaceError error = surface_error(scene, baked, ErrorSpace::linear);
  EXPECT_GT(truth.rmse, 1e-4);
  EXPECT_NEAR(error.rmse, truth.rmse, 0.01 * truth.rmse);
  EXPECT_NEAR(error.max_sampled, truth.max, 0.01 * truth.max);
}

TEST(SurfaceError, LightOfAnyStrength_HasErrorsThatFollowIt) {
  const auto error_of = [](float strength) {
    Light hard = spot({0.3f, 1, 0.1f}, {0, -1, 0}, 0.4f, 0.4f);  // Its edge is integrated finely.
    hard.intensity = {strength, strength, strength};
    const Scene scene = scene_of(grid(1, 1), {hard});
    return surface_error(scene, bake(scene, {}), ErrorSpace::linear);
  };
  const SurfaceError one = error_of(1);
  for (const float strength : {0x1p-90f, 0x1p+90f}) {
    const SurfaceError other = error_of(strength);
    EXPECT_DOUBLE_EQ(other.rmse, one.rmse * strength);
    EXPECT_DOUBLE_EQ(other.max_sampled, one.max_sampled * strength);
  }
}

TEST(SurfaceErrors, StoredCoarsely_AgreeWithOneByOne) {
  for (const NamedScene& s : small_scenes()) {
    SCOPED_TRACE(s.name);
    const BakedColors computed = bake(s.scene, {.method = BakeMethod::sample});
    BakedColors stored = computed;
    take_stored_colors(s.scene, storing([](const LinearRgb& c) {
                         const auto step = [](float x) { return std::round(std::min(x, 1.0f) * 16) / 16; };
                         return LinearRgb{step(c.r), step(c.g), step(c.b)};
                       }),
                       stored);
    const SurfaceErrors errors = surface_errors(s.scene, stored, computed.colors);
    const SurfaceError linear = surface_error(s.scene, stored, ErrorSpace::linear);
    const SurfaceError display = surface_error(s.scene, stored, ErrorSpace::display);
    // Each is integrated to 2e-4 of its RMSE.
    EXPECT_NEAR(errors.linear.rmse, linear.rmse, 5e-4 * linear.rmse);
    EXPECT_NEAR(errors.display.rmse, display.rmse, 5e-4 * display.rmse);
    EXPECT_NEAR(errors.display.max_sampled, display.max_sampled, 1e-3 * display.max_sampled);
    const double before = surface_error(s.scene, computed, ErrorSpace::linear).rmse;
    EXPECT_NEAR(errors.computed_rmse, before, 5e-4 * before);
    const SurfaceErrors as_computed = surface_errors(s.scene, computed, computed.colors);
    EXPECT_EQ(as_computed.computed_rmse, as_computed.linear.rmse);
  }
}

TEST(SurfaceError, FlatFaceUnderASun_IsZero) {
  const Scene scene = scene_of(grid(1, 1), {sun({0, 1, 0}), sun({0, -1, 0})});
  const SurfaceError error = surface_error(scene, bake(scene, {}), ErrorSpace::display);
  EXPECT_EQ(error.rmse, 0);
  EXPECT_EQ(error.max_sampled, 0);
  EXPECT_TRUE(error.worst.empty());
  EXPECT_DOUBLE_EQ(error.area, 4);
}

TEST(SurfaceError, ConstantOffset_IsThatOffset) {
  const Scene scene = scene_of(grid(3, 1), {sun({0, 1, 0}, {0.25f, 0.25f, 0.25f})});
  BakedColors baked = bake(scene, {});
  for (LinearRgb& c : baked.colors) c += {0.5f, 0.5f, 0.5f};
  const SurfaceError error = surface_error(scene, baked, ErrorSpace::linear);
  EXPECT_NEAR(error.rmse, 0.5, 1e-7);
  EXPECT_NEAR(error.mae, 0.5, 1e-7);
  EXPECT_NEAR(error.mean, 0.5, 1e-7);
  EXPECT_NEAR(error.max_sampled, 0.5, 1e-7);
}

TEST(SurfaceErrors, EmissionThatDoesNotShow_IsMissing) {
  Scene scene = scene_of(grid(3, 1), {sun({0, 1, 0}, {0.25f, 0.25f, 0.25f})});
  scene.materials[0].emission = {0.5f, 0.5f, 0.5f};
  BakedColors baked = bake(scene, {});
  EXPECT_EQ(surface_errors(scene, baked, baked.colors).linear.rmse, 0);
  baked.hidden_emission = {true};
  const SurfaceErrors errors = surface_errors(scene, baked, baked.colors);
  EXPECT_NEAR(errors.linear.rmse, 0.5, 1e-7);
  EXPECT_NEAR(errors.linear.mean, -0.5, 1e-7);
  EXPECT_NEAR(errors.display.max_sampled, srgb_encode(0.75) - srgb_encode(0.25), 1e-7);
  EXPECT_EQ(errors.computed_rmse, 0);
  baked.hidden_emission = {true, false};
  EXPECT_THROW(surface_error(scene, baked, ErrorSpace::linear), InvalidScene);
}

// The lamp over the middle of a square of half side a at height h: the light there is 1/h², at the corners
// h/(h² + 2a²)^1.5.
TEST(SurfaceError, QuadUnderALamp_MissesTheMiddleByTheClosedForm) {
  for (const double h : {2.0, 1.0, 0.5}) {
    const Scene scene = scene_of(grid(1, 1), {lamp({0, static_cast<float>(h), 0})});
    const SurfaceError error = surface_error(scene, bake(scene, {}), ErrorSpace::linear);
    const double missing = 1 / (h * h) - h / std::pow(h * h + 2, 1.5);
    EXPECT_NEAR(error.max_sampled, missing, 1e-6 * missing) << "h = " << h;
    ASSERT_FALSE(error.worst.empty());
    EXPECT_NEAR(glm::length(error.worst[0].position), 0, 1e-3);
  }
}

// As lit places get small between vertices that get next to no light, the square of the error integrates to
// that of the light: π/(2h²) for a lamp at height h; to the order of α² for a spot of half angle α at height
// 1, whose light is ((α² − θ²)/s)² with s = max(0.002, α²): π α¹⁰/(5 s⁴).
// The integration promises 1e-3 of the RMSE; the rest of the tolerance is what the closed forms leave out.
TEST(SurfaceError, SmallLitPlacesInALargeTriangle_IntegrateToTheClosedForm) {
  for (const float size : {0.1f, 0.02f, 0.005f, 0.001f}) {
    SCOPED_TRACE(size);
    const auto rmse = [&](const Light& light) {
      const Scene scene = scene_of(grid(1, 1), {light});
      return surface_error(scene, bake(scene, {}), ErrorSpace::linear).rmse;
    };
    constexpr double pi = std::numbers::pi;
    const double of_lamp = std::sqrt(pi / (2 * size * size) / 4);
    EXPECT_NEAR(rmse(lamp({0.3f, size, 0.1f})), of_lamp, (0.002 + size) * of_lamp);
    const double s = std::max(0.002, double(size) * size);
    const double of_spot = std::sqrt(pi * std::pow(size, 10) / (5 * std::pow(s, 4)) / 4);
    EXPECT_NEAR(rmse(spot({0.3f, 1, 0.1f}, {0, -1, 0}, 0, size)), of_spot, (0.002 + size * size) * of_spot);
  }
}

TEST(SurfaceError, LightsOfAnySize_GiveTheSameOnTwoTrianglesAsOnMany) {
  // Colours of 0: what is integrated is the light, whatever the triangles.
  const auto error_on = [](unsigned n, const Light& light) {
    const Scene scene = scene_of(grid(n, 1), {light});
    BakedColors baked = bake(scene, {});
    std::fill(baked.colors.begin(), baked.colors.end(), LinearRgb{});
    return surface_error(scene, baked, ErrorSpace::linear);
  };
  for (const float size : {0.05f, 0.1f, 0.2f, 0.3f, 0.45f, 0.7f, 1.0f}) {
    Light ranged = lamp({0.3f, size, -0.2f}, {1, 1, 1}, 0.5f);
    ranged.range = 1.2f;
    for (const Light& light : {spot({0.3f, 1, 0.1f}, {0.2f, -1, 0.1f}, 0, size),
                               spot({-0.9f, 0.6f, 0.8f}, {0.4f, -0.3f, -0.6f}, size / 2, size),
                               lamp({0.3f, size, -0.2f}), ranged}) {
      const SurfaceError two = error_on(1, light), many = error_on(32, light);
      EXPECT_NEAR(two.rmse, many.rmse, 1e-3 * many.rmse) << size;
      EXPECT_NEAR(two.mae, many.mae, 5e-3 * many.mae) << size;
    }
  }
}

TEST(SurfaceError, SpotOnATexture_IsNoMoreMissedThanWithoutOne) {
  Scene scene = scene_of(grid(1, 1), {spot({0.31f, 1, 0.12f}, {0, -1, 0}, 0, 0.01f)});
  const double plain = surface_error(scene, bake(scene, {}), ErrorSpace::linear).rmse;
  EXPECT_GT(plain, 5e-6);
  Image image{1, 1, {}};
  image.pixels.emplace_back(1.0f);
  scene.images.push_back(image);
  scene.textures.emplace_back();
  scene.materials[0].base_color_texture = 0;
  EXPECT_NEAR(surface_error(scene, bake(scene, {}), ErrorSpace::linear).rmse, plain, 5e-3 * plain);
}

TEST(SurfaceError, MaeWhereTheErrorChangesItsSign_IsExactWhereItIsLinear) {
  Mesh mesh = grid(1, 1);
  for (const glm::vec3& p : mesh.positions) mesh.colors.push_back(LinearRgb{(p.x + 1) / 2, 0, 0});
  const Scene scene = scene_of(mesh, {sun({0, 1, 0})});
  BakedColors baked = bake(scene, {});
  std::fill(baked.colors.begin(), baked.colors.end(), LinearRgb{0.5f, 0, 0});
  const SurfaceError error = surface_error(scene, baked, ErrorSpace::linear);
  EXPECT_NEAR(error.mae, 0.25 / 3, 1e-7);
  EXPECT_NEAR(error.rmse, std::sqrt(1.0 / 12 / 3), 1e-7);
  EXPECT_NEAR(error.mean, 0, 1e-7);
}

TEST(SurfaceError, WorstOfATriangle_IsSigned_BelowZeroWhereLightIsMissing) {
  const Scene lamp_over_quad = scene_of(grid(1, 1), {lamp({0, 1, 0})});
  const Scene terminator = scene_of(icosphere(2), {sun({0, 1, 0})});
  const SurfaceError missing = surface_error(lamp_over_quad, bake(lamp_over_quad, {}), ErrorSpace::linear);
  const SurfaceError bleeding = surface_error(terminator, bake(terminator, {}), ErrorSpace::linear);
  for (const float worst : missing.triangle_worst) EXPECT_LT(worst, -0.5f);
  EXPECT_GT(bleeding.triangle_worst[bleeding.worst[0].triangle], 0);
}

TEST(SurfaceError, WorstPlaces_NameTheirTriangleAndLight) {
  const Scene scene = scene_of(icosphere(2), {sun({0, 1, 0}, {0.01f, 0.01f, 0.01f}), sun({1, 0, 0})});
  const SurfaceError error = surface_error(scene, bake(scene, {}), ErrorSpace::display);
  ASSERT_EQ(error.worst.size(), 8U);
  EXPECT_EQ(error.max_sampled, error.worst[0].error);
  for (std::size_t i = 0; i < error.worst.size(); ++i) {
    const SurfacePlace& place = error.worst[i];
    EXPECT_LE(place.error, error.worst[i > 0 ? i - 1 : 0].error);
    EXPECT_FLOAT_EQ(std::abs(error.triangle_worst[place.triangle]), static_cast<float>(place.error));
  }
  EXPECT_EQ(error.worst[0].light, 1U);
  EXPECT_NEAR(error.worst[0].position.x, 0, 0.05) << "the terminator of the strong sun";
}

TEST(SurfaceError, EmptyAndZeroAreaAndNonFinite_CountNothing) {
  Scene empty = scene_of(Mesh{}, {sun({0, 1, 0})});
  EXPECT_EQ(surface_error(empty, bake(empty, {}), ErrorSpace::linear).area, 0);
  Mesh mesh = grid(1, 1);
  mesh.positions.push_back({NAN, 0, 0});
  mesh.normals.clear();
  mesh.texcoords = {};
  mesh.triangles.push_back({0, 1, 4});
  mesh.triangles.push_back({0, 1, 1});
  const Scene scene = scene_of(mesh, {lamp({0, 1, 0})});
  const SurfaceError error = surface_error(scene, bake(scene, {}), ErrorSpace::linear);
  EXPECT_DOUBLE_EQ(error.area, 4);
  EXPECT_TRUE(std::isfinite(error.rmse));
}

TEST(SurfaceError, OneAndTwoThreads_GiveTheSameBits) {
  const Scene scene = scene_of(icosphere(3), {sun({0.4f, 1, 0.3f}), lamp({1.2f, 0.5f, 0})});
  const BakedColors baked = bake(scene, {});
  set_thread_count(1);
  const SurfaceError one = surface_error(scene, baked, ErrorSpace::display);
  set_thread_count(0);
  const SurfaceError all = surface_error(scene, baked, ErrorSpace::display);
  EXPECT_EQ(one.rmse, all.rmse);
  EXPECT_EQ(one.mean, all.mean);
  EXPECT_EQ(one.max_sampled, all.max_sampled);
  EXPECT_EQ(one.triangle_worst, all.triangle_worst);
}

TEST(SurfaceError, WorstPlace_NamesALightOnlyWhereOneReachesIt) {
  Scene scene = scene_of(grid(1, 1), {sun({0, 1, 0}), sun({0, -1, 0})});
  BakedColors wrong = bake(scene, {});
  for (LinearRgb& c : wrong.colors) c = {0.25f, 0.25f, 0.25f};
  EXPECT_EQ(surface_error(scene, wrong, ErrorSpace::display).worst.at(0).light, 0U);
  scene.lights.erase(scene.lights.begin());
  EXPECT_FALSE(surface_error(scene, wrong, ErrorSpace::display).worst.at(0).light);
}

}  // namespace
}  // namespace lambake
