#include "lambake/core/bounds.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace lambake {
namespace {

TEST(Bounds, OfNothing_AreEmpty_WithoutARadius) {
  EXPECT_TRUE(bounds_of({}).is_empty());
  EXPECT_EQ(bounds_of({}).radius(), 0);
}

TEST(Bounds, LeaveOutWhatIsNotFinite) {
  const std::array<glm::vec3, 4> points = {glm::vec3(1, 2, 3), {NAN, -9, 0}, {-1, INFINITY, 0}, {3, 2, -1}};
  const Bounds box = bounds_of(points);
  EXPECT_EQ(box.min, glm::vec3(1, 2, -1));
  EXPECT_EQ(box.max, glm::vec3(3, 2, 3));
  EXPECT_EQ(box.center(), glm::vec3(2, 2, 1));
  EXPECT_FLOAT_EQ(box.radius(), std::sqrt(5.0f));
}

TEST(Bounds, OfCoordinatesNearTheLargestFloat_HaveAFiniteCenter) {
  const std::array<glm::vec3, 2> points = {glm::vec3(3e38f, 0, 0), {2e38f, 0, 0}};
  EXPECT_EQ(bounds_of(points).center().x, 2.5e38f);
}

}  // namespace
}  // namespace lambake
