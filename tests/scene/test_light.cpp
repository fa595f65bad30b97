#include "lambake/scene/light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "lambake/core/error.h"

namespace lambake {
namespace {

Light spot() {
  Light light;
  light.type = LightType::spot;
  return light;
}

TEST(CheckLight, Defaults_AreSound) {
  EXPECT_NO_THROW(check_light({}, "here"));
  EXPECT_NO_THROW(check_light({.type = LightType::point}, "here"));
  EXPECT_NO_THROW(check_light(spot(), "here"));
}

TEST(CheckLight, Limits_AreSound) {
  Light light = spot();
  light.intensity = {0, 0, 0};
  light.decay = 0;
  light.outer_cone_rad = std::numbers::pi_v<float> / 2;
  EXPECT_NO_THROW(check_light(light, "here"));
  light.inner_cone_rad = light.outer_cone_rad;
  EXPECT_NO_THROW(check_light(light, "here"));
}

TEST(CheckLight, WhatIsOutOfRange_IsRefused_TellingWhere) {
  const std::vector<std::function<void(Light&)>> broken = {
      [](Light& l) { l.intensity.g = -1; },
      [](Light& l) { l.intensity.b = NAN; },
      [](Light& l) { l.position.x = INFINITY; },
      [](Light& l) { l.decay = -0.5f; },
      [](Light& l) { l.decay = INFINITY; },
      [](Light& l) { l.range = -1; },
      [](Light& l) { l.range = NAN; },
      [](Light& l) {
        l.spot_direction = {0, 0, 2};
      },
      [](Light& l) {
        l.spot_direction = {0, 0, 0};
      },
      [](Light& l) { l.inner_cone_rad = -0.1f; },
      [](Light& l) { l.inner_cone_rad = std::nextafter(l.outer_cone_rad, 2.0f); },
      [](Light& l) { l.inner_cone_rad = l.outer_cone_rad = 0; },
      [](Light& l) { l.outer_cone_rad = 1.6f; },
      [](Light& l) { l.outer_cone_rad = NAN; },
      [](Light& l) {
        l.type = LightType::directional, l.direction_to_light = {0, 0, 0};
      },
      [](Light& l) {
        l.type = LightType::directional, l.direction_to_light = {NAN, 0, 1};
      }};
  for (std::size_t i = 0; i < broken.size(); ++i) {
    Light light = spot();
    broken[i](light);
    try {
      check_light(light, "light 7");
      ADD_FAILURE() << "case " << i;
    } catch (const InvalidOption& error) {
      EXPECT_EQ(std::string(error.what()).rfind("light 7: expected", 0), 0U) << error.what();
    }
  }
}

TEST(CheckLight, WhatTheTypeDoesNotUse_DoesNotMatter) {
  Light sun;
  sun.position = {NAN, 0, 0};
  sun.decay = -1;
  sun.outer_cone_rad = 9;
  EXPECT_NO_THROW(check_light(sun, "here"));
}

}  // namespace
}  // namespace lambake
