#include "lambake/shading/light_kernel.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>

#include "lambake/core/error.h"
#include "lambake/core/vector_path.h"
#include "lambake/shading/lambert.h"

namespace lambake {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

struct Random {
  std::mt19937 engine{7};
  float operator()(float low, float high) {
    return low + (high - low) * static_cast<float>(engine()) / 4294967296.0f;
  }
  glm::vec3 unit() {
    return glm::normalize(glm::vec3((*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1)) + glm::vec3(1e-3f));
  }
};

Light sun(Random& random) {
  Light light;
  light.intensity = {random(0, 1), random(0, 1), random(0, 1)};
  light.direction_to_light = random.unit();
  return light;
}

Light lamp(Random& random, float decay = 2, float range = 0) {
  Light light;
  light.type = LightType::point;
  light.intensity = {random(0, 1), random(0, 1), random(0, 1)};
  light.position = {random(-3, 3), random(-3, 3), random(-3, 3)};
  light.decay = decay;
  light.range = range;
  return light;
}

Light spot(Random& random, float decay = 2) {
  Light light = lamp(random, decay, 4);
  light.type = LightType::spot;
  light.spot_direction = random.unit();
  light.inner_cone_rad = random(0, 0.5f);
  light.outer_cone_rad = random(0.6f, 1.5f);
  return light;
}

struct Points {
  std::vector<glm::vec3> positions, normals;
};

/// Random points, and among them those that give no light or no direction.
Points points(std::size_t n, const std::vector<Light>& lights) {
  Random random;
  Points p;
  for (std::size_t i = 0; i < n; ++i) {
    p.positions.push_back({random(-2, 2), random(-2, 2), random(-2, 2)});
    p.normals.push_back(random.unit());
    const float value[] = {nan, infinity, -infinity, 1e30f};
    if (i % 13 == 3) p.positions.back()[static_cast<int>(i % 3)] = value[i / 13 % 4];
    if (i % 11 == 4) p.normals.back() = glm::vec3(0);
    if (i % 7 == 5 && !lights.empty()) p.positions.back() = lights[i % lights.size()].position;
  }
  return p;
}

class LightKernel : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { choose_vector_path(GetParam()); }
  void TearDown() override { choose_vector_path(""); }
};

void expect_the_equation(const std::vector<Light>& lights, std::size_t n) {
  const Points p = points(n, lights);
  std::vector<LinearRgb> out(n, LinearRgb{nan, nan, nan});
  irradiance(pack_lights(lights), p.positions, p.normals, out);
  for (std::size_t i = 0; i < n; ++i) {
    const glm::vec3 e = irradiance<float>(lights, p.positions[i], p.normals[i]);
    ASSERT_TRUE(is_finite(out[i])) << "point " << i << " of " << n;
    ASSERT_EQ(std::memcmp(&e, &out[i], sizeof e), 0)
        << "point " << i << " of " << n << ": " << e.r << " " << out[i].r;
  }
}

TEST_P(LightKernel, Suns_AnyNumberOfPoints_EqualTheEquationToTheLastBit) {
  Random random;
  for (std::size_t n = 0; n < 70; ++n) expect_the_equation({sun(random), sun(random)}, n);
}

TEST_P(LightKernel, InverseSquareLamps_AnyNumberOfPoints_EqualTheEquationToTheLastBit) {
  Random random;
  std::vector<Light> lights;
  for (int i = 0; i < 40; ++i) lights.push_back(lamp(random));
  for (std::size_t n = 0; n < 70; ++n) expect_the_equation(lights, n);
  expect_the_equation(lights, 5000);
}

TEST_P(LightKernel, EveryExponentWithAndWithoutRange_EqualsTheEquationToTheLastBit) {
  Random random;
  for (const float decay : {0.0f, 0.5f, 1.0f, 2.0f, 2.7f, 3.0f, 4.0f})
    for (const float range : {0.0f, 0.5f, 5.0f}) {
      SCOPED_TRACE(testing::Message() << "decay " << decay << " range " << range);
      expect_the_equation({lamp(random, decay, range), lamp(random, decay, range)}, 500);
    }
}

TEST_P(LightKernel, Spots_EqualTheEquationToTheLastBit) {
  Random random;
  std::vector<Light> lights;
  for (int i = 0; i < 20; ++i) lights.push_back(spot(random, static_cast<float>(i % 5)));
  expect_the_equation(lights, 2000);
}

TEST_P(LightKernel, KindsInAnyOrder_AreSummedInTheOrderOfTheLights) {
  Random random;
  std::vector<Light> lights;
  for (int i = 0; i < 60; ++i) {
    const int kind = static_cast<int>(random(0, 4));
    lights.push_back(kind == 0   ? sun(random)
                     : kind == 1 ? spot(random)
                     : kind == 2 ? lamp(random, 1)
                                 : lamp(random));
  }
  expect_the_equation(lights, 2000);
}

TEST_P(LightKernel, SquaredDistanceBelowTheSmallestNumber_GivesNoLight) {
  Light light;
  light.type = LightType::point;
  const std::vector<glm::vec3> positions(20, glm::vec3(-1e-30f, 0, 0)), normals(20, glm::vec3(1, 0, 0));
  for (const float decay : {0.0f, 1.0f, 2.0f}) {
    light.decay = decay;
    std::vector<LinearRgb> out(20, LinearRgb{1, 1, 1});
    irradiance(pack_lights(std::vector<Light>{light}), positions, normals, out);
    EXPECT_EQ(out, std::vector<LinearRgb>(20));
  }
}

TEST_P(LightKernel, NoLight_IsBlack) {
  expect_the_equation({}, 37);
}

TEST_P(LightKernel, PointsInTwoCalls_SameBitsAsInOne) {
  Random random;
  const std::vector<Light> lights{lamp(random), sun(random), spot(random, 3)};
  const Points p = points(101, lights);
  const PackedLights packed = pack_lights(lights);
  std::vector<LinearRgb> whole(101), cut(101);
  irradiance(packed, p.positions, p.normals, whole);
  const std::span<const glm::vec3> positions = p.positions, normals = p.normals;
  const std::span<LinearRgb> out = cut;
  irradiance(packed, positions.first(29), normals.first(29), out.first(29));
  irradiance(packed, positions.subspan(29), normals.subspan(29), out.subspan(29));
  EXPECT_EQ(whole, cut);
}

INSTANTIATE_TEST_SUITE_P(EveryPath, LightKernel, testing::ValuesIn(vector_paths()),
                         [](const auto& path) { return path.param; });

TEST(PackedLights, SunsAlone_NeedNoPositions) {
  Random random;
  const std::vector<Light> suns{sun(random), sun(random)};
  const PackedLights packed = pack_lights(suns);
  EXPECT_FALSE(packed.needs_positions);
  const std::vector<glm::vec3> normals(50, glm::vec3(0, 1, 0));
  std::vector<LinearRgb> out(50);
  irradiance(packed, {}, normals, out);
  const glm::vec3 e = irradiance<float>(suns, glm::vec3(0), normals[0]);
  for (const LinearRgb& c : out) EXPECT_EQ(c, (LinearRgb{e.r, e.g, e.b}));
}

TEST(PackedLights, ALampWithoutPositions_IsRefused) {
  Random random;
  const std::vector<glm::vec3> normals(4, glm::vec3(0, 1, 0));
  std::vector<LinearRgb> out(4);
  EXPECT_THROW(irradiance(pack_lights(std::vector<Light>{lamp(random)}), {}, normals, out), InvalidOption);
}

}  // namespace
}  // namespace lambake
