#include "lambake/scene/local_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lambake {
namespace {

Scene scene_at(const glm::vec3& offset, LightType type) {
  Scene scene;
  for (const glm::vec3& p : {glm::vec3(-1, 0, -1), glm::vec3(1, 0.25f, 1), glm::vec3(0.5f, -0.5f, 1)})
    scene.mesh.positions.push_back(p + offset);
  Light light;
  light.type = type;
  light.position = glm::vec3(0.5f, 2, 0.25f) + offset;
  scene.lights = {light};
  return scene;
}

TEST(LocalFrame, NearTheOriginOrUnderSuns_NothingIsMovedOrCopied) {
  for (const Scene& scene : {scene_at({0, 0, 0}, LightType::point), scene_at({30, -8, 4}, LightType::point),
                             scene_at({1 << 20, 0, 0}, LightType::directional),
                             scene_at({-3, 1 << 20, 7}, LightType::directional)}) {
    const LocalFrame local(scene);
    EXPECT_EQ(&local.positions(), &scene.mesh.positions);
    EXPECT_EQ(local.lights().data(), scene.lights.data());
  }
}

TEST(LocalFrame, FarAway_DistancesStayToTheBit_AndAreNear) {
  const Scene near = scene_at({0, 0, 0}, LightType::spot);
  for (const int exponent : {8, 12, 20})
    for (const glm::vec3& axes : {glm::vec3(1, 0, 0), glm::vec3(0, -1, 0), glm::vec3(1, 1, -1)}) {
      const Scene far = scene_at(axes * std::ldexp(1.0f, exponent), LightType::spot);
      const LocalFrame local(far);
      for (std::size_t v = 0; v < 3; ++v) {
        EXPECT_EQ(local.positions()[v] - local.lights()[0].position,
                  near.mesh.positions[v] - near.lights[0].position);
        EXPECT_LT(glm::length(local.positions()[v]), 3);
      }
    }
}

TEST(LocalFrame, EmptyOrNotFinite_IsLeftAsItIs) {
  Scene scene = scene_at({1 << 20, 0, 0}, LightType::point);
  scene.mesh.positions[0].x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(std::isnan(LocalFrame(scene).positions()[0].x));
  EXPECT_LT(std::abs(LocalFrame(scene).positions()[1].x), 3);
  scene.mesh.positions.assign(3, glm::vec3(std::numeric_limits<float>::infinity()));
  EXPECT_EQ(&LocalFrame(scene).positions(), &scene.mesh.positions);
  scene.mesh.positions.clear();
  EXPECT_TRUE(LocalFrame(scene).positions().empty());
}

}  // namespace
}  // namespace lambake
