#include "lambake/shading/lambert.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace lambake {
namespace {

constexpr double pi = std::numbers::pi;

/// The direction `angle` away from +z, towards +x.
template <typename Real>
glm::vec<3, Real> tilted(Real angle) {
  return {std::sin(angle), Real(0), std::cos(angle)};
}

Light lamp(const glm::vec3& position, float decay = 2) {
  Light light;
  light.type = LightType::point;
  light.position = position;
  light.decay = decay;
  return light;
}

/// A spot at `position` that shines down −z.
Light spot(const glm::vec3& position, double inner_deg, double outer_deg) {
  Light light = lamp(position, 0);
  light.type = LightType::spot;
  light.spot_direction = {0, 0, -1};
  light.inner_cone_rad = static_cast<float>(inner_deg * pi / 180);
  light.outer_cone_rad = static_cast<float>(outer_deg * pi / 180);
  return light;
}

template <typename Real>
class Lambert : public testing::Test {
 public:
  using Point = glm::vec<3, Real>;
  /// A few units in the last place of values around 1; lights are stored in float.
  static constexpr Real tolerance = Real(4e-7);
  Real lit(const Light& light, const Point& position, const Point& normal = {0, 0, 1}) {
    return received(light, position, normal);
  }
};

using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(Lambert, Reals);

TYPED_TEST(Lambert, Sun_GivesTheCosine_AndNothingFromBehind) {
  using Vec = glm::vec<3, TypeParam>;
  Light sun;
  for (const double degrees : {0, 30, 60, 90, 120, 180}) {
    sun.direction_to_light = glm::vec3(tilted(degrees * pi / 180));
    EXPECT_NEAR(this->lit(sun, Vec(0)), std::max(0.0, std::cos(degrees * pi / 180)), this->tolerance)
        << degrees;
  }
  EXPECT_EQ(this->lit(sun, Vec(0)), 0);  // From behind exactly nothing.
}

TYPED_TEST(Lambert, Sun_IsTheSameEverywhere) {
  using Vec = glm::vec<3, TypeParam>;
  const Light sun{.direction_to_light = glm::vec3(0.6f, 0, 0.8f)};
  EXPECT_EQ(this->lit(sun, Vec(1e6, -3, 7)), this->lit(sun, Vec(0)));
}

TYPED_TEST(Lambert, Lamp_AtHalfTheDistance_GivesFourTimesTheLight) {
  using Vec = glm::vec<3, TypeParam>;
  EXPECT_EQ(this->lit(lamp({0, 0, 2}), Vec(0)), TypeParam(0.25));
  EXPECT_EQ(this->lit(lamp({0, 0, 1}), Vec(0)), TypeParam(1));
}

TYPED_TEST(Lambert, Lamp_OffTheAxis_GivesTheCosineOverTheSquaredDistance) {
  using Vec = glm::vec<3, TypeParam>;
  EXPECT_NEAR(this->lit(lamp({3, 0, 4}), Vec(0)), 0.8 / 25, this->tolerance / 25);
  EXPECT_EQ(this->lit(lamp({3, 0, -4}), Vec(0)), 0);
  EXPECT_EQ(this->lit(lamp({3, 0, 0}), Vec(0)), 0);
}

TYPED_TEST(Lambert, Decay_IsTheExponentOfTheDistance) {
  using Vec = glm::vec<3, TypeParam>;
  for (const float k : {0.0f, 0.5f, 1.0f, 2.0f, 3.0f, 4.0f})
    EXPECT_NEAR(this->lit(lamp({0, 0, 3}, k), Vec(0)), std::pow(3.0, -k), this->tolerance) << k;
}

TYPED_TEST(Lambert, Range_FadesByTheFourthPower_AndEndsThere) {
  using Vec = glm::vec<3, TypeParam>;
  Light light = lamp({0, 0, 0}, 0);
  light.range = 4;
  const auto at = [&](double distance) { return this->lit(light, Vec(0, 0, -distance)); };
  EXPECT_NEAR(at(1), 1 - std::pow(0.25, 4), this->tolerance);
  EXPECT_NEAR(at(2), 1 - std::pow(0.5, 4), this->tolerance);
  EXPECT_NEAR(at(3), 1 - std::pow(0.75, 4), this->tolerance);
  EXPECT_GT(at(3.999), 0);
  EXPECT_EQ(at(4), 0);
  EXPECT_EQ(at(5), 0);
}

TYPED_TEST(Lambert, Spot_IsFullInside_NothingOutside_ASquaredRampBetween) {
  using Vec = glm::vec<3, TypeParam>;
  const Light light = spot({0, 0, 1}, 20, 40);
  // The point at `degrees` off the axis, on a sphere around the light; its normal faces the light.
  const auto at = [&](double degrees) {
    const Vec away = tilted(TypeParam(degrees * pi / 180));
    return this->lit(light, Vec(-away.x, 0, 1 - away.z), away);
  };
  EXPECT_NEAR(at(0), 1, this->tolerance);
  EXPECT_NEAR(at(19.9), 1, this->tolerance);
  const double ramp = (std::cos(30 * pi / 180) - std::cos(40 * pi / 180)) /
                      (std::cos(20 * pi / 180) - std::cos(40 * pi / 180));
  EXPECT_NEAR(at(30), ramp * ramp, 10 * this->tolerance);  // The ramp is 6 times steeper than the cosine.
  EXPECT_GT(at(39.9), 0);
  EXPECT_EQ(at(40.1), 0);
  EXPECT_EQ(at(90), 0);
}

TYPED_TEST(Lambert, Spot_OfATenthOfADegree_KeepsItsDigits) {
  // Cosines of such angles differ from 1 by some steps of float. The ramp counts at least 0.001.
  using Vec = glm::vec<3, TypeParam>;
  Light light = spot({1, 10, 2}, 0, 0.1);
  light.intensity = {1, 1, 1};
  const glm::dvec3 axis = glm::normalize(glm::dvec3(-1, -10, -2));
  light.spot_direction = glm::vec3(axis);
  const glm::dvec3 side = glm::normalize(glm::cross(axis, glm::dvec3(0, 0, 1)));
  for (const double degrees : {0.01, 0.03, 0.05, 0.08}) {
    const double angle = degrees * pi / 180;
    const glm::dvec3 away = std::cos(angle) * axis + std::sin(angle) * side;
    const double expected = (std::cos(angle) - std::cos(double(light.outer_cone_rad))) / 0.001;
    const Vec position(glm::dvec3(light.position) + away);
    EXPECT_NEAR(this->lit(light, position, Vec(-away)), expected * expected, 0.003 * 2.4e-6) << degrees;
  }
}

TYPED_TEST(Lambert, ALightOnThePoint_GivesNothing) {
  using Vec = glm::vec<3, TypeParam>;
  for (const float k : {0.0f, 1.0f, 2.0f, 4.0f}) {
    EXPECT_EQ(this->lit(lamp({1, 2, 3}, k), Vec(1, 2, 3)), 0);
    Light on_point = spot({1, 2, 3}, 20, 40);
    on_point.decay = k;
    EXPECT_EQ(this->lit(on_point, Vec(1, 2, 3)), 0);
  }
}

TYPED_TEST(Lambert, NoDirection_OrAPositionThatIsNotFinite_GetsNoLight) {
  using Vec = glm::vec<3, TypeParam>;
  EXPECT_EQ(this->lit({}, Vec(0), Vec(0)), 0);
  EXPECT_EQ(this->lit(lamp({0, 0, 1}), Vec(0), Vec(0)), 0);
  EXPECT_EQ(this->lit(lamp({0, 0, 1}), Vec(NAN, 0, 0)), 0);
  EXPECT_EQ(this->lit(lamp({0, 0, 1}), Vec(INFINITY, 0, 0)), 0);
}

TYPED_TEST(Lambert, Lights_AddUp_ColourByColour) {
  using Vec = glm::vec<3, TypeParam>;
  std::array<Light, 2> lights = {lamp({0, 0, 2}), Light{.direction_to_light = {0, 0, 1}}};
  lights[0].intensity = {4, 8, 0};
  lights[1].intensity = {0, 1, 0.5f};
  EXPECT_EQ(irradiance(std::span<const Light>(lights), Vec(0), Vec(0, 0, 1)), Vec(1, 3, 0.5));
}

}  // namespace
}  // namespace lambake
