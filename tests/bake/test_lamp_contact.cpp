#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "lambake/bake/bake.h"
#include "shapes.h"

namespace lambake {
namespace {

Light lamp(const glm::vec3& position, float decay, const LinearRgb& intensity = {1, 0, 0}) {
  Light light;
  light.type = LightType::point;
  light.position = position;
  light.decay = decay;
  light.intensity = intensity;
  return light;
}

Scene scene_of(Mesh mesh, std::vector<Light> lights) {
  Scene scene;
  mesh.normals.assign(mesh.n_vertices(), {0, 1, 0});
  scene.mesh = std::move(mesh);
  scene.materials.resize(1);
  scene.lights = std::move(lights);
  return scene;
}

std::size_t count_of(const BakedColors& baked, const std::string& code) {
  for (const Finding& finding : baked.findings)
    if (finding.code == code) return finding.count;
  return 0;
}

TEST(LampContact, VerticesExactlyOnLamps_AreCounted_AndGetTheOtherLights) {
  const Mesh mesh = grid(4, 1);
  const Light sun{.direction_to_light = {0, 1, 0}};
  const Scene scene = scene_of(
      mesh, {lamp(mesh.positions[3], 2), lamp(mesh.positions[7], 0), lamp(mesh.positions[7], 1), sun});
  const BakedColors baked = bake(scene, {});
  EXPECT_EQ(count_of(baked, "points_on_a_lamp"), 2U);
  EXPECT_EQ(count_of(baked, "points_too_bright"), 0U);
  EXPECT_EQ(baked.colors[3], (LinearRgb{1, 1, 1}));
}

TEST(LampContact, VertexThatIsNowhere_LiesOnNoLamp) {
  Mesh mesh = grid(2, 1);
  mesh.positions.emplace_back(NAN, NAN, NAN);
  mesh.texcoords = {};
  EXPECT_EQ(count_of(bake(scene_of(mesh, {lamp({5, 6, 7}, 2)}), {}), "points_on_a_lamp"), 0U);
}

TEST(LampContact, SoCloseThatFloatOverflows_IsCounted_FiniteAndWithoutThatLamp) {
  // 1/d² overflows below 5e-20, 1/d⁴ below 2e-10; times an intensity of 0 in green that is not a number.
  for (const auto& [decay, height] : {std::pair{2.0f, 1e-20f}, {4.0f, 1e-10f}, {4.0f, 1e-15f}}) {
    Mesh mesh = grid(2, 1);
    mesh.colors.assign(mesh.n_vertices(), {0.5f, 0, 1});
    const Scene scene = scene_of(mesh, {lamp({0, height, 0}, decay), lamp({0, 2, 0}, 0, {0, 1, 1})});
    for (const BakeMethod method : {BakeMethod::sample, BakeMethod::face}) {
      const BakedColors baked = bake(scene, {.method = method});
      for (const LinearRgb& c : baked.colors) EXPECT_TRUE(is_finite(c));
    }
    const BakedColors baked = bake(scene, {});
    EXPECT_EQ(count_of(baked, "points_too_bright"), 1U) << decay;
    EXPECT_EQ(baked.colors[4], (LinearRgb{0, 0, 1})) << decay;
  }
}

TEST(LampContact, AtTheCentreOfAFace_IsCountedForTheMethodThatLightsThere) {
  Mesh mesh;
  mesh.positions = {{-3, 0, 0}, {0, 0, 3}, {3, 0, -3}};
  mesh.triangles = {{0, 1, 2}};
  const Scene scene = scene_of(mesh, {lamp({0, 0, 0}, 2)});
  EXPECT_EQ(count_of(bake(scene, {.method = BakeMethod::face}), "points_on_a_lamp"), 1U);
  EXPECT_EQ(count_of(bake(scene, {}), "points_on_a_lamp"), 0U);
}

TEST(LampContact, SunsAlone_TellNothing) {
  EXPECT_TRUE(bake(scene_of(grid(2, 1), {Light{}}), {}).findings.empty());
}

}  // namespace
}  // namespace lambake
