#include <gtest/gtest.h>

#include "lambake/measure/light_share.h"

namespace lambake {
namespace {

Light sun(const glm::vec3& direction, float intensity) {
  Light light;
  light.direction_to_light = direction;
  light.intensity = {intensity, intensity, intensity};
  return light;
}

/// Two triangles that make the square [−1,1]² in z = 0, facing +z, under the given lights.
Scene square(std::vector<Light> lights) {
  Scene scene;
  scene.mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  scene.mesh.normals.assign(4, {0, 0, 1});
  scene.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.materials.resize(1);
  scene.lights = std::move(lights);
  return scene;
}

TEST(LightShares, SunsOnAFlatFace_ShareByIntensityTimesCosine_WithoutError) {
  const auto shares = light_shares(square({sun({0, 0, 1}, 1), sun({0.8f, 0, 0.6f}, 5), sun({0, 0, -1}, 9)}));
  ASSERT_EQ(shares.size(), 3U);
  EXPECT_NEAR(shares[0].light, 0.25, 1e-6);  // 1·1 of 1·1 + 5·0.6
  EXPECT_NEAR(shares[1].light, 0.75, 1e-6);
  EXPECT_EQ(shares[2].light, 0);  // from behind
  for (const LightShare& share : shares) EXPECT_NEAR(share.error, 0, 1e-9);
}

TEST(LightShares, UnlitFaces_TakeNone) {
  Scene scene = square({sun({0, 0, 1}, 1), sun({1, 0, 0}, 1)});
  scene.materials.resize(2);
  scene.materials[1].is_unlit = true;
  scene.mesh.positions.insert(scene.mesh.positions.end(), {{0, 0, 0}, {0, 9, 0}, {0, 0, 9}});
  scene.mesh.normals.insert(scene.mesh.normals.end(), 3, {1, 0, 0});
  scene.mesh.triangles.push_back({4, 5, 6});
  scene.mesh.materials = {0, 0, 1};
  EXPECT_EQ(light_shares(scene)[1].light, 0);
}

TEST(LightShares, LampOverAFace_HasTheError_NotTheSun) {
  Light lamp;
  lamp.type = LightType::point;
  lamp.position = {0, 0, 0.5f};
  const auto shares = light_shares(square({sun({0, 0, 1}, 10), lamp}));
  EXPECT_LT(shares[1].light, 0.5);
  EXPECT_NEAR(shares[1].error, 1, 1e-6);
}

TEST(LightShares, ManyLights_AreEstimatedFromSomeTriangles) {
  // Every third triangle, which is what is looked at of 9 million pairs, faces the first sun.
  Scene scene = square({sun({0, 0, 1}, 1), sun({0, 0, -1}, 1), sun({0, 0, -1}, 1)});
  const auto n = static_cast<std::uint32_t>(scene.mesh.n_vertices());
  for (std::uint32_t v = 0; v < n; ++v) {
    scene.mesh.positions.push_back(glm::vec3(scene.mesh.positions[v]));
    scene.mesh.normals.push_back(-glm::vec3(scene.mesh.normals[v]));
  }
  scene.mesh.triangles.clear();
  for (std::uint32_t f = 0; f < 3'000'000; ++f) {
    const std::uint32_t first = f % 3 == 0 ? 0 : n;
    scene.mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  const std::vector<LightShare> shares = light_shares(scene);
  EXPECT_EQ(shares[0].light, 1);
  EXPECT_EQ(shares[1].light, 0);
}

TEST(LightShares, NothingLit_IsZero) {
  EXPECT_EQ(light_shares(square({sun({0, 0, -1}, 1)}))[0].light, 0);
  EXPECT_TRUE(light_shares(square({})).empty());
}

}  // namespace
}  // namespace lambake
