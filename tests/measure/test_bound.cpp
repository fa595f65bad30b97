#include "lambake/measure/bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lambake/core/parallel.h"
#include "lambake/measure/surface_error.h"
#include "lambake/shading/finish.h"
#include "scenes.h"

namespace lambake {
namespace {

TEST(SurfaceBound, SmallScenes_NeverBelowTheSampledErrorAndNotFarAbove) {
  for (const NamedScene& s : small_scenes())
    for (const ErrorSpace space : {ErrorSpace::linear, ErrorSpace::display}) {
      SCOPED_TRACE(s.name + (space == ErrorSpace::linear ? ", linear" : ", display"));
      const BakedColors baked = bake(s.scene, {});
      const SurfaceError error = surface_error(s.scene, baked, space);
      BoundOptions options;
      options.space = space;
      const SurfaceBound bound = surface_bound(s.scene, baked, options);
      ASSERT_EQ(bound.triangle_bound.size(), s.scene.mesh.n_triangles());
      std::vector<double> ratios;
      for (std::size_t f = 0; f < bound.triangle_bound.size(); ++f) {
        const float worst = std::abs(error.triangle_worst[f]);
        EXPECT_GE(bound.triangle_bound[f], worst) << "triangle " << f;
        if (worst > 1e-6) ratios.push_back(bound.triangle_bound[f] / worst);
      }
      EXPECT_GE(bound.max_bound, error.max_sampled);
      EXPECT_LE(bound.max_bound, 1.11 * error.max_sampled);
      EXPECT_EQ(bound.unbounded_triangles, 0U);
      ASSERT_FALSE(ratios.empty());
      std::sort(ratios.begin(), ratios.end());
      EXPECT_LE(ratios[ratios.size() / 2], 1.3);
      EXPECT_LE(ratios[ratios.size() * 99 / 100], 3);
    }
}

TEST(SurfaceBound, FlatFaceUnderASun_IsZeroToRounding) {
  const Scene scene = scene_of(grid(1, 1), {sun({0, 1, 0})});
  EXPECT_LT(surface_bound(scene, bake(scene, {}), {}).max_bound, 1e-6);
}

TEST(SurfaceBound, LampOnACurvedSurface_IsUnboundedThereOnly) {
  Mesh mesh = grid(4, 1);
  for (const glm::vec3& p : mesh.positions)  // hollow, so that the lamp lights its triangle
    mesh.normals.push_back(glm::normalize(glm::vec3(0, 1, 0) - 0.4f * p));
  const Scene scene = scene_of(mesh, {lamp({0.1f, 0, 0.2f}, {0.01f, 0.01f, 0.01f})});
  BoundOptions options;
  options.space = ErrorSpace::linear;
  const SurfaceBound bound = surface_bound(scene, bake(scene, {}), options);
  EXPECT_EQ(bound.unbounded_triangles, 1U);
  EXPECT_TRUE(std::isinf(bound.max_bound));
  const auto side_of_lamp = [&](const glm::vec3& a, const glm::vec3& b) {
    return (b.z - a.z) * (0.1f - a.x) - (b.x - a.x) * (0.2f - a.z);
  };
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    const glm::uvec3& t = mesh.triangles[f];
    const glm::vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    const bool has_lamp = side_of_lamp(a, b) >= 0 && side_of_lamp(b, c) >= 0 && side_of_lamp(c, a) >= 0;
    EXPECT_EQ(std::isinf(bound.triangle_bound[f]), has_lamp) << "triangle " << f;
  }
}

// A normal spread of θ along an edge costs 1 − cos(θ/2) in its middle: here over a whole triangle with two
// equal normals, the light along the mean.
TEST(SurfaceBound, SpreadNormals_CostTheClosedForm) {
  for (const float theta : {0.1f, 0.5f, 1.5f}) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
    mesh.triangles = {{0, 2, 1}};
    const float s = std::sin(theta / 2), c = std::cos(theta / 2);
    mesh.normals = {{-s, c, 0}, {s, c, 0}, {-s, c, 0}};
    const Scene scene = scene_of(mesh, {sun({0, 1, 0})});
    BoundOptions options;
    options.space = ErrorSpace::linear;
    options.tightness = 1.001;
    options.max_parts = 4000;
    const double truth = 1 - std::cos(theta / 2.0);
    const SurfaceBound bound = surface_bound(scene, bake(scene, {}), options);
    EXPECT_GE(bound.max_bound, truth * (1 - 1e-6));
    EXPECT_LE(bound.max_bound, truth * 1.0011 + 2e-7);
  }
}

// Colours clip on both sides of a comparison on screen, and count below 0 as black.
TEST(SurfaceBound, OnScreen_ClippedColoursDoNotDiffer) {
  const Scene scene = scene_of(grid(1, 1), {sun({0, 1, 0}, {3, 2, 1.5f})});
  BakedColors baked = bake(scene, {});
  for (LinearRgb& c : baked.colors) c = {2, 5, 1};
  EXPECT_LT(surface_bound(scene, baked, {}).max_bound, 1e-9);
}

// Black for white is off by all there is, and by no more.
TEST(SurfaceBound, OnScreen_NothingIsAbove1) {
  const Scene scene = scene_of(grid(1, 1), {sun({0, 1, 0}, {3, 3, 3})});
  BakedColors baked = bake(scene, {});
  for (LinearRgb& c : baked.colors) c = {0, 0, 0};
  EXPECT_EQ(surface_bound(scene, baked, {}).max_bound, 1);
}

// Such a corner shows texel 0, wherever the others are.
TEST(SurfaceBound, TextureCoordinateThatIsNoNumber_LeavesTheWholeTexture) {
  Scene scene = scene_of(grid(1, 1), {sun({0, 1, 0})});
  scene.images = {{8, 1, std::vector<glm::vec4>(8, glm::vec4(1))}};
  scene.images[0].pixels[0] = glm::vec4(0, 0, 0, 1);
  scene.textures.resize(1);
  scene.materials[0].base_color_texture = 0;
  scene.mesh.texcoords[0].assign(scene.mesh.n_vertices(), {0.6f, 0.5f});
  const Finishes sound(scene);
  EXPECT_GT(sound.over(scene.mesh, 0).base_low.r, 0.9);
  scene.mesh.texcoords[0][scene.mesh.triangles[0][1]].x = NAN;
  const FinishRange range = Finishes(scene).over(scene.mesh, 0);
  EXPECT_EQ(range.base_low.r, 0);
  EXPECT_GE(range.base_high.r, 1);
}

TEST(SurfaceBound, OneAndTwoThreads_GiveTheSameBits) {
  const Scene scene = scene_of(icosphere(3), {sun({0.4f, 1, 0.3f}), lamp({1.2f, 0.5f, 0})});
  const BakedColors baked = bake(scene, {});
  set_thread_count(1);
  const SurfaceBound one = surface_bound(scene, baked, {});
  set_thread_count(0);
  EXPECT_EQ(one.triangle_bound, surface_bound(scene, baked, {}).triangle_bound);
}

// A texel is in the range with its own value, however wide the image is and however far out the coordinates.
TEST(TexelRange, OneBrightTexel_IsTheUpperEnd) {
  Scene scene = scene_of(grid(1, 1), {sun({0, 1, 0})});
  Image image{3000, 1, {}};
  image.pixels.assign(3000, glm::vec4(0.25f, 0.25f, 0.25f, 1));
  constexpr int bright = 1777;
  image.pixels[bright] = glm::vec4(1);
  scene.images = {image};
  scene.textures.emplace_back();
  scene.materials[0].base_color_texture = 0;
  for (const float turns : {0.0f, 1.0f, -1.0f, 31.0f}) {
    const float u = turns + (bright + 0.5f) / 3000;
    scene.mesh.texcoords[0].assign(scene.mesh.n_vertices(), glm::vec2(u, 0.5f));
    scene.mesh.texcoords[0][0].x += 2.0f / 3000;
    const FinishRange range = Finishes(scene).over(scene.mesh, 0);
    EXPECT_GE(range.base_high.r, 1) << turns;
    EXPECT_NEAR(range.base_low.r, 0.25, 1e-5) << turns;
  }
}

}  // namespace
}  // namespace lambake
