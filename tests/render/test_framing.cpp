#include "lambake/render/framing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lambake/core/bounds.h"
#include "lambake/core/error.h"

namespace lambake {
namespace {

/// Smallest angle between a side of the view and the sphere, as seen from the eye; negative: it is cut off.
double angle_left(const Camera& camera, const glm::dvec3& center, double radius, double aspect) {
  const glm::dvec3 c(glm::inverse(glm::dmat4(camera.world_from_camera)) * glm::dvec4(center, 1));
  const double distance = glm::length(c);
  const double half_y = 0.5 * double(camera.vertical_fov_rad), half_x = std::atan(std::tan(half_y) * aspect);
  double least = 10;
  for (const double sign : {-1.0, 1.0}) {
    least = std::min(least, half_x - std::atan2(sign * c.x, -c.z) - std::asin(radius / distance));
    least = std::min(least, half_y - std::atan2(sign * c.y, -c.z) - std::asin(radius / distance));
  }
  return least;
}

std::vector<glm::vec3> corners(const Bounds& box) {
  std::vector<glm::vec3> points;
  for (int i = 0; i < 8; ++i)
    points.push_back(glm::mix(box.min, box.max, glm::vec3(i & 1, i >> 1 & 1, i >> 2)));
  return points;
}

TEST(Framing, AnyAspectAndScale_SeesTheWholeSphereAndLittleElse) {
  for (const float aspect : {0.25f, 1.0f, 1.7778f, 4.0f})
    for (const float scale : {1e-9f, 1.0f, 1e9f}) {
      const Bounds bounds{glm::vec3(1, 2, 3) * scale, glm::vec3(2, 5, 4) * scale};
      for (const Camera& camera : frame_around(corners(bounds), aspect, 5)) {
        const double left = angle_left(camera, bounds.center(), bounds.radius(), aspect);
        EXPECT_GT(left, 0) << aspect;
        EXPECT_LT(left, 0.02) << aspect;
        const glm::vec3 eye(camera.world_from_camera[3]);
        EXPECT_LT(camera.near_distance, glm::length(eye - bounds.center()) - bounds.radius());
        EXPECT_GT(camera.near_distance, 0);
        EXPECT_GT(camera.world_from_camera[1].y, 0.5f);  // upright
      }
    }
}

// A model that is turned with its axes looks the same.
TEST(Framing, ZUp_IsTheSameViewOfATurnedModel) {
  const auto turned = [](const glm::vec3& v) { return glm::vec3(v.x, -v.z, v.y); };
  const std::vector<glm::vec3> points = corners({{1, 2, 3}, {2, 5, 4}});
  std::vector<glm::vec3> turned_points;
  for (const glm::vec3& p : points) turned_points.push_back(turned(p));
  std::vector<Camera> y_up = frame_around(points, 1.5f, 3),
                      z_up = frame_around(turned_points, 1.5f, 3, Up::z);
  y_up.push_back(frame(points, 1));
  z_up.push_back(frame(turned_points, 1, Up::z));
  for (const glm::vec3& eye : {glm::vec3(7, 1, 2), {1, 20, 3}, {1, -20, 3}}) {
    y_up.push_back(look_at(eye, {1, 2, 3}, 1));
    z_up.push_back(look_at(turned(eye), turned({1, 2, 3}), 1, Up::z));
  }
  for (std::size_t i = 0; i < y_up.size(); ++i)
    for (int column = 0; column < 4; ++column) {
      const glm::vec3 expected = turned(glm::vec3(y_up[i].world_from_camera[column]));
      EXPECT_LT(glm::length(glm::vec3(z_up[i].world_from_camera[column]) - expected), 1e-5f) << i;
    }
}

TEST(Framing, FirstOfTheViewsAround_IsTheFramedOne) {
  const Bounds bounds{{0, 0, 0}, {1, 1, 1}};
  const std::vector<Camera> views = frame_around(corners(bounds), 1.5f, 4);
  ASSERT_EQ(views.size(), 4u);
  EXPECT_EQ(views[0].world_from_camera, frame(corners(bounds), 1.5f).world_from_camera);
  const glm::vec3 towards_first(views[0].world_from_camera[2]), towards_third(views[2].world_from_camera[2]);
  EXPECT_NEAR(towards_third.x, -towards_first.x, 1e-6f);
  EXPECT_NEAR(towards_third.y, towards_first.y, 1e-6f);
}

TEST(Framing, Ball_IsFramedByItsOwnRadiusAndNotItsBoxes) {
  const std::vector<glm::vec3> ball = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  const double left = angle_left(frame(ball, 1), {0, 0, 0}, 1, 1);
  EXPECT_GT(left, 0);
  EXPECT_LT(left, 0.02);
}

TEST(Framing, NoneOrOneOrNotFinitePoints_GiveAFiniteCamera) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const std::vector<glm::vec3>& points :
       {std::vector<glm::vec3>{}, {{2, 2, 2}}, {{nan, 0, 0}}, {{1, 2, 3}, {nan, 0, 0}, {4, 5, 6}}})
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) EXPECT_TRUE(std::isfinite(frame(points, 1).world_from_camera[i][j]));
}

TEST(Framing, PointsAtTheEndsOfFloat_AreRefused) {
  EXPECT_NO_THROW(frame(std::vector<glm::vec3>{{-1e37f, 0, 0}, {1e37f, 0, 0}}, 1));
  EXPECT_THROW(frame(std::vector<glm::vec3>{{-3e38f, 0, 0}, {3e38f, 0, 0}}, 1), InvalidScene);
}

TEST(LookAt, AnyDirection_MapsTheTargetToTheMiddleAndKeepsLengths) {
  const glm::vec3 target(1, 2, 3);
  for (const glm::vec3& eye : {glm::vec3(4, 5, 6), glm::vec3(1, 9, 3), glm::vec3(1, -9, 3)}) {
    const Camera camera = look_at(eye, target, 0.7f);
    const glm::dmat4 to_camera = glm::inverse(glm::dmat4(camera.world_from_camera));
    const glm::dvec3 seen(to_camera * glm::dvec4(target, 1));
    EXPECT_NEAR(seen.x, 0, 1e-6);
    EXPECT_NEAR(seen.y, 0, 1e-6);
    EXPECT_NEAR(seen.z, -glm::length(eye - target), 1e-5);
    EXPECT_NEAR(glm::determinant(to_camera), 1, 1e-6);
  }
}

TEST(LookAt, StraightDownOrUp_IsTheLimitOfAnEyeTowardsZ) {
  for (const float height : {3.0f, -3.0f}) {
    const Camera straight = look_at({0, height, 0}, {0, 0, 0}, 0.6f);
    const Camera beside = look_at({0, height, 0.06f}, {0, 0, 0}, 0.6f);
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r)
        // The other looks 0.02 radians off.
        EXPECT_NEAR(straight.world_from_camera[c][r], beside.world_from_camera[c][r], 0.03) << height;
  }
}

TEST(LookAt, NoDirectionOrNoAngle_Throws) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(look_at({1, 2, 3}, {1, 2, 3}, 0.7f), InvalidOption);
  EXPECT_THROW(look_at({nan, 2, 3}, {1, 2, 3}, 0.7f), InvalidOption);
  EXPECT_THROW(look_at({0, 0, 1}, {0, 0, 0}, 0), InvalidOption);
  EXPECT_THROW(look_at({0, 0, 1}, {0, 0, 0}, 3.2f), InvalidOption);
  EXPECT_THROW(look_at({0, 0, 1}, {0, 0, 0}, nan), InvalidOption);
}

}  // namespace
}  // namespace lambake
