#include "lambake/shading/moved_corners.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "shading/random.h"

namespace lambake {
namespace {

Patch random_patch(Random& random) {
  Patch patch;
  for (int k = 0; k < 3; ++k)
    for (int c = 0; c < 3; ++c) {
      patch.positions[k][c] = random(-1, 1);
      patch.colors[k][c] = random(0, 1);
    }
  return patch;
}

/// Barycentrics of the foot of p in the plane of the patch.
glm::dvec3 barycentrics_of(const Patch& patch, const glm::dvec3& p) {
  const glm::dvec3 e1 = patch.positions[1] - patch.positions[0], e2 = patch.positions[2] - patch.positions[0],
                   d = p - patch.positions[0];
  const double a = glm::dot(e1, e1), b = glm::dot(e1, e2), c = glm::dot(e2, e2);
  const double x = glm::dot(d, e1), y = glm::dot(d, e2), det = a * c - b * b;
  const double b1 = (c * x - b * y) / det, b2 = (a * y - b * x) / det;
  return {1 - b1 - b2, b1, b2};
}

TEST(MovedCorners, NoneMovedOrNoArea_ChangesNothing) {
  Random random;
  Patch patch = random_patch(random);
  EXPECT_EQ(change_by_moved_corners(patch, {}, {patch.positions}, ErrorSpace::linear), 0);
  patch.positions[2] = patch.positions[1];
  EXPECT_EQ(change_by_moved_corners(patch, {}, {glm::dmat3(0.0)}, ErrorSpace::linear), 0);
}

TEST(MovedCorners, AlongTheGradientOfARightTriangle_TheSlopeTimesTheMove) {
  Patch patch;
  patch.positions = {glm::dvec3(0, 0, 0), glm::dvec3(2, 0, 0), glm::dvec3(0, 1, 0)};
  patch.colors = {glm::dvec3(0), glm::dvec3(0.5), glm::dvec3(0)};
  const auto moved = [&](const glm::dvec3& move) {
    glm::dmat3 stored = patch.positions;
    stored[0] += move;
    return change_by_moved_corners(patch, {}, {stored}, ErrorSpace::linear);
  };
  EXPECT_DOUBLE_EQ(moved({0.1, 0, 0}), 0.025);
  EXPECT_DOUBLE_EQ(moved({-0.1, 0, 0}), 0.025);
  EXPECT_DOUBLE_EQ(moved({0, 0.1, 0}), 0);
  EXPECT_DOUBLE_EQ(moved({0, 0, 0.1}), 0);  // Out of the plane.
  FinishRange half;
  half.base_low = half.base_high = glm::dvec3(0.5);
  glm::dmat3 stored = patch.positions;
  stored[0].x += 0.1;
  EXPECT_DOUBLE_EQ(change_by_moved_corners(patch, half, {stored}, ErrorSpace::linear), 0.0125);
}

TEST(MovedCorners, BoundWithAChange_IsTheSumButOnScreenNoMoreThanAll) {
  EXPECT_EQ(bound_with_change(0.5, 0.25, ErrorSpace::linear), 0.75);
  EXPECT_EQ(bound_with_change(0.5, 0.25, ErrorSpace::display), 0.75);
  EXPECT_EQ(bound_with_change(0.75, 0.5, ErrorSpace::linear), 1.25);
  EXPECT_EQ(bound_with_change(0.75, 0.5, ErrorSpace::display), 1);
  EXPECT_TRUE(std::isinf(bound_with_change(INFINITY, 0.5, ErrorSpace::display)));
}

// The change at a point: the stored triangle shows there what the patch has at the same barycentrics.
TEST(MovedCorners, RandomPatches_NoChangeIsAboveTheBound) {
  Random random;
  for (const ErrorSpace space : {ErrorSpace::linear, ErrorSpace::display})
    for (int i = 0; i < 2000; ++i) {
      const Patch patch = random_patch(random);
      glm::dmat3 stored = patch.positions;
      for (int k = 0; k < 3; ++k)
        for (int c = 0; c < 3; ++c) stored[k][c] += random(-1e-3, 1e-3);
      FinishRange finish;
      finish.base_low = glm::dvec3(random(0, 0.5));
      finish.base_high = finish.base_low + random(0, 0.5);
      finish.emission_low = finish.emission_high = glm::dvec3(random(0, 0.1));
      const double bound = change_by_moved_corners(patch, finish, {stored}, space);
      double found = 0;
      for (int k = 0; k < 20; ++k) {
        glm::dvec3 b(random(0, 1), random(0, 1), random(0, 1));
        if (k < 3) b = glm::dvec3(k == 0, k == 1, k == 2);
        b /= b.x + b.y + b.z;
        const glm::dvec3 shown = patch.colors * b, there = patch.colors * barycentrics_of(patch, stored * b);
        for (int c = 0; c < 3; ++c)
          for (const double base : {finish.base_low[c], finish.base_high[c]}) {
            const double e = finish.emission_low[c];
            found = std::max(
                found, std::abs(compared(base * shown[c] + e, space) - compared(base * there[c] + e, space)));
          }
      }
      EXPECT_LE(found, bound * (1 + 1e-9)) << i;
      if (space == ErrorSpace::linear) {
        EXPECT_GE(found, bound * (1 - 1e-9)) << i;
      }
    }
}

TEST(MovedCorners, RoundingInAnyDirection_TheSteepestSlopeTimesIt) {
  Patch patch;
  patch.positions = {glm::dvec3(0, 0, 0), glm::dvec3(2, 0, 0), glm::dvec3(0, 1, 0)};
  patch.colors = {glm::dvec3(0), glm::dvec3(0.6), glm::dvec3(0.4)};  // slopes 0.3 and 0.4
  EXPECT_DOUBLE_EQ(change_by_moved_corners(patch, {}, {patch.positions, 0.1}, ErrorSpace::linear), 0.05);
}

TEST(MovedCorners, TexturesThatMoveByMoreThanGpusResolve_ChangeByThatShareOfTheirRange) {
  Patch patch;
  patch.positions = {glm::dvec3(0, 0, 0), glm::dvec3(2, 0, 0), glm::dvec3(0, 1, 0)};
  patch.colors = {glm::dvec3(0.5), glm::dvec3(0.5), glm::dvec3(0.5)};
  FinishRange finish;
  finish.base_low = glm::dvec3(0.2), finish.emission_high = glm::dvec3(0.1);
  TexelCorners texels{{glm::dvec2(0, 0), glm::dvec2(64, 0), glm::dvec2(0, 32)}};
  const auto change = [&](double move, std::size_t of, bool is_nearest = false) {
    StoredCorners stored{patch.positions};
    stored.positions[2].x += move;
    texels.is_nearest = is_nearest;
    stored.texels[of] = texels;
    return change_by_moved_corners(patch, finish, stored, ErrorSpace::linear);
  };
  EXPECT_EQ(change(1.0 / 8193, 0), 0);                     // 32 texels to one unit: below 1/256 of one
  EXPECT_DOUBLE_EQ(change(1.0 / 64, 0), 0.5 * 0.8 * 0.5);  // half a texel, of 0.2 to 1, lit with 0.5
  EXPECT_DOUBLE_EQ(change(1.0 / 64, 1), 0.5 * 0.1);        // of the emission
  EXPECT_DOUBLE_EQ(change(1.0 / 64, 0, true), 0.8 * 0.5);  // across the edge of a texel
  texels.rounding = {0, 0.25};                             // coordinates far out
  EXPECT_DOUBLE_EQ(change(0, 0), 0.25 * 0.8 * 0.5);
}

}  // namespace
}  // namespace lambake
