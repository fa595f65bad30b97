#include "lambake/measure/select.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lambake/measure/surface_error.h"
#include "scenes.h"
#include "storing.h"

namespace lambake {
namespace {

TEST(SelectMethod, FlatGridUnderASun_NeedsNoMoreThanSampling) {
  const Selection selection = select_method(scene_of(grid(4, 1), {sun({0.4f, 1, 0.3f})}), {});
  ASSERT_EQ(selection.trials.size(), 2U);  // What comes behind could not be smaller.
  EXPECT_TRUE(selection.is_certified);
  const MethodTrial& chosen = selection.trials[selection.chosen];
  EXPECT_TRUE(chosen.is_certified);
  for (const MethodTrial& trial : selection.trials)
    EXPECT_TRUE(!trial.is_certified || chosen.bytes <= trial.bytes);
  EXPECT_NE(selection.sentence.find("suffices"), std::string::npos);
}

TEST(SelectMethod, SphereUnderASun_NeedsCuts) {
  const Scene scene = scene_of(icosphere(3), {sun({0.4f, 1, 0.3f})});
  const Selection selection = select_method(scene, {});
  EXPECT_TRUE(selection.is_certified);
  EXPECT_EQ(selection.trials[selection.chosen].method, BakeMethod::adaptive);
  EXPECT_LE(surface_error(scene, selection.baked, ErrorSpace::display).max_sampled, 1.0 / 255);
  EXPECT_NE(selection.sentence.find("642 → "), std::string::npos) << selection.sentence;
  for (const MethodTrial& trial : selection.trials) EXPECT_GE(trial.max_bound, trial.max_found);
}

TEST(SelectMethod, TooFewVertices_SaysThatPixelsAreNeeded) {
  const Scene scene = scene_of(icosphere(2), {sun({0.4f, 1, 0.3f})});
  const Selection selection = select_method(scene, {.max_vertices = 170});
  EXPECT_FALSE(selection.is_certified);
  EXPECT_EQ(selection.sentence.rfind("per-pixel lighting is needed", 0), 0U) << selection.sentence;
  EXPECT_LE(selection.baked.mesh->n_vertices(), 170U);
}

// Colours in sixteenths: most of what is left is rounding, and light per pixel is not what is missing.
TEST(SelectMethod, MostlyRounding_DecidesNothing) {
  const Scene scene = scene_of(icosphere(3), {sun({0.4f, 1, 0.3f})});
  const ColorOutput coarse = storing([](const LinearRgb& c) {
    const auto rounded = [](float channel) { return std::round(channel * 16) / 16; };
    return LinearRgb{rounded(c.r), rounded(c.g), rounded(c.b)};
  });
  const Selection rounded = select_method(scene, {.output = coarse});
  EXPECT_NE(rounded.sentence.find("would do for"), std::string::npos) << rounded.sentence;
  const Selection both = select_method(scene, {.max_vertices = 670, .output = coarse});
  EXPECT_EQ(both.sentence.rfind("not decided: ", 0), 0U) << both.sentence;
  EXPECT_NE(both.sentence.find("mostly as the output clips or rounds"), std::string::npos) << both.sentence;
}

TEST(SelectMethod, TooLittleTime_DecidesNothing) {
  const Scene scene = scene_of(icosphere(5), {sun({0.4f, 1, 0.3f})});
  const Selection selection = select_method(scene, {.max_seconds = 1e-6});
  EXPECT_FALSE(selection.is_certified);
  EXPECT_EQ(selection.sentence.rfind("not decided in 1e-06 s", 0), 0U) << selection.sentence;
}

}  // namespace
}  // namespace lambake
