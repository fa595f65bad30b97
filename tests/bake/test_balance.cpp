#include "lambake/bake/balance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lambake/bake/side_error.h"
#include "measure/scenes.h"

namespace lambake {
namespace {

constexpr std::array<std::uint32_t, 1> only_light{0};

/// A triangle whose normals lean outwards by `spread` at each corner, with the reference as its colours.
Patch bent_patch(double spread, const std::vector<Light>& lights) {
  Patch patch;
  for (int k = 0; k < 3; ++k) {
    const double angle = 2.0943951023931953 * k;
    patch.positions[k] = {std::cos(angle), 0, -std::sin(angle)};
    patch.normals[k] = {std::sin(spread) * std::cos(angle), std::cos(spread),
                        -std::sin(spread) * std::sin(angle)};
  }
  for (int k = 0; k < 3; ++k) {
    glm::dvec3 corner(0);
    corner[k] = 1;
    patch.colors[k] = reference_at(patch, lights, only_light, false, corner);
  }
  return patch;
}

/// The largest error over a grid of places, as compared; its place.
std::pair<double, glm::dvec3> largest_error(const Patch& patch, const std::vector<Light>& lights,
                                            ErrorSpace space) {
  std::pair<double, glm::dvec3> worst{0, glm::dvec3(1.0 / 3)};
  constexpr int n = 60;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      const glm::dvec3 b(double(i) / n, double(j) / n, double(n - i - j) / n);
      const glm::dvec3 f = reference_at(patch, lights, only_light, false, b), g = patch.colors * b;
      const double e = std::abs(compared(f[0], space) - compared(g[0], space));
      if (e > worst.first) worst = {e, b};
    }
  return worst;
}

// An error of one sign between vertices without one: moved by half of it, it is nowhere more than half.
TEST(Balance, SmoothErrorOfOneSign_IsHalved) {
  const std::vector<Light> lights{sun({0.1f, 1, 0.2f}, {0.7f, 0.7f, 0.7f})};
  for (const ErrorSpace space : {ErrorSpace::linear, ErrorSpace::display})
    for (const double spread : {0.05, 0.2, 0.5}) {
      SCOPED_TRACE(spread);
      Patch patch = bent_patch(spread, lights);
      const auto [before, place] = largest_error(patch, lights, space);
      ASSERT_GT(before, 1e-4);
      // The share of what the corners may is the same for all, so their colours may differ by the light's
      // variation over the triangle: 2 % of room.
      const double allowed = 0.51 * before;
      const glm::dmat3 exact = patch.colors;
      const glm::dmat3 shifts = balancing_shifts(patch, exact, {}, lights, only_light, place, allowed, space);
      patch.colors = exact + shifts;
      EXPECT_LE(largest_error(patch, lights, space).first, allowed * (1 + 1e-6));
      EXPECT_GT(shifts[0][0], 0);
    }
}

TEST(Balance, ErrorsOfMoreThanTwiceWhatIsAllowed_MoveNothing) {
  const std::vector<Light> lights{sun({0.1f, 1, 0.2f})};
  const Patch patch = bent_patch(0.3, lights);
  const auto [error, place] = largest_error(patch, lights, ErrorSpace::linear);
  for (const double share : {0.45, 1.01})  // too much to be balanced; nothing to be done
    EXPECT_EQ(balancing_shifts(patch, patch.colors, {}, lights, only_light, place, share * error,
                               ErrorSpace::linear),
              glm::dmat3(0.0));
}

// n·ω runs from -0.3 to 0.7 along the side: the kink is at 0.3, where the colours are at 0.3 of the lit
// end's.
TEST(SideError, TerminatorAcrossASide_IsFoundWithItsError) {
  const std::vector<Light> lights{sun({0, 1, 0})};
  Patch patch;
  patch.positions = {glm::dvec3(0), glm::dvec3(1, 0, 0), glm::dvec3(1, 0, 0)};
  patch.normals[0] = {1, -0.3, 0};
  patch.normals[1] = patch.normals[2] = {1, 0.7, 0};
  const glm::dvec3 lit = reference_at(patch, lights, only_light, false, {0, 1, 0});
  patch.colors = {glm::dvec3(0), lit, lit};
  const SideError side = side_error(patch, {}, lights, only_light, ErrorSpace::linear);
  EXPECT_NEAR(side.t, 0.3, 1e-12);
  EXPECT_NEAR(side.error, 0.3 * lit[0], 1e-12);
  EXPECT_NEAR(side.bulge, side.error, 1e-12);
}

// Colours off at the ends are no reason to cut there: the cut goes where the error bulges.
TEST(SideError, ErrorAtTheEnds_IsCountedButNotCutAt) {
  const std::vector<Light> lights{sun({0, 1, 0})};
  Patch patch = bent_patch(0.4, lights);
  patch.colors[0] += 0.2;
  const SideError side = side_error(patch, {}, lights, only_light, ErrorSpace::linear);
  EXPECT_NEAR(side.error, 0.2, 1e-12);
  EXPECT_NEAR(side.t, 0.5, 0.02);  // symmetric
}

}  // namespace
}  // namespace lambake
