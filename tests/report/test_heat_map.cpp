#include <gtest/gtest.h>

#include <cmath>

#include "lambake/core/error.h"
#include "lambake/report/difference.h"
#include "lambake/report/report.h"
#include "report/test_comparison.h"

namespace lambake {
namespace {

/// A row of covered grey pixels, 0.5 on screen, whose red is off by `steps[i]`/255 in the test.
struct Row {
  Picture test, reference;
  Visibility visibility;

  explicit Row(const std::vector<double>& steps) {
    const auto n = static_cast<std::uint32_t>(steps.size());
    visibility.width = n, visibility.height = 1, visibility.n_covered = n;
    visibility.triangles.assign(n, 0);
    const auto grey = static_cast<float>(srgb_decode(0.5));
    reference = {n, 1, std::vector<LinearRgb>(n, {grey, grey, grey})};
    test = reference;
    for (std::size_t i = 0; i < n; ++i)
      test.pixels[i].r = static_cast<float>(srgb_decode(0.5 + steps[i] / 255));
  }
  Picture map(double scale) const { return heat_map(test, reference, visibility, scale); }
};

double luminance(const LinearRgb& c) {
  return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b;
}

TEST(HeatMap, Sign_DarkerIsBlue_BrighterIsRed_EqualIsWhite) {
  const Picture map = Row({-6, 0, 6}).map(8.0 / 255);
  EXPECT_GT(map.pixels[0].b, map.pixels[0].r);
  EXPECT_GT(map.pixels[2].r, map.pixels[2].b);
  EXPECT_EQ(to_srgb8(map.pixels[1]), (Srgb8{247, 247, 247}));
}

TEST(HeatMap, Size_GetsDarkerAlike_SoThatItReadsWithoutColour) {
  const Picture map = Row({-8, -6, -4, -2, 0, 2, 4, 6, 8}).map(8.0 / 255);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT(luminance(map.pixels[i]), luminance(map.pixels[i + 1]));
    EXPECT_LT(luminance(map.pixels[8 - i]), luminance(map.pixels[7 - i]));
  }
}

TEST(HeatMap, LargestChannelDecides) {
  Row row({2});
  row.test.pixels[0].b = static_cast<float>(srgb_decode(0.5 - 5.0 / 255));
  const Picture map = row.map(8.0 / 255);
  EXPECT_GT(map.pixels[0].b, map.pixels[0].r);
}

TEST(HeatMap, BeyondTheScale_HasTheEndColour) {
  const Picture map = Row({8, 60}).map(8.0 / 255);
  EXPECT_EQ(to_srgb8(map.pixels[0]), to_srgb8(map.pixels[1]));
}

TEST(HeatMap, AboveWhite_IsNoDifferenceOnScreen) {
  Row row({0});
  row.test.pixels[0] = {3, 3, 3}, row.reference.pixels[0] = {1, 1, 1};
  EXPECT_EQ(to_srgb8(row.map(8.0 / 255).pixels[0]), (Srgb8{247, 247, 247}));
}

TEST(HeatMap, ColoursOfTriangles_AreThoseOfThePixels) {
  const std::vector<double> steps = {-60, -6, 0, 3, 8};
  const Picture map = Row(steps).map(8.0 / 255);
  std::vector<float> differences;
  for (const double step : steps) differences.push_back(static_cast<float>(step / 255));
  differences.push_back(NAN);
  const std::vector<Srgb8> colors = heat_colors(differences, 8.0 / 255);
  ASSERT_EQ(colors.size(), steps.size() + 1);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Srgb8 pixel = to_srgb8(map.pixels[i]);
    EXPECT_NEAR(colors[i].r, pixel.r, 1);  // The pixels' differences went through linear float.
    EXPECT_NEAR(colors[i].b, pixel.b, 1);
  }
  EXPECT_EQ(colors.back(), (Srgb8{255, 0, 255}));
}

TEST(HeatMap, UncoveredAndNotFinite_DifferFromEveryColourOfTheBar) {
  Row row({0, 0, -8, 8});
  row.visibility.triangles[0] = no_triangle;
  row.test.pixels[1].g = NAN;
  const Picture map = row.map(8.0 / 255);
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(to_srgb8(map.pixels[i]), to_srgb8(map.pixels[j]));
}

TEST(HeatMap, Scale_TheStepThatHolds99Percent) {
  EXPECT_EQ(heat_map_scale(Row({0}).test, Row({0}).reference, Row({0}).visibility), 1.0 / 255);
  std::vector<double> steps(1000, 5.0);
  steps[3] = 100;
  const Row row(steps);
  EXPECT_EQ(heat_map_scale(row.test, row.reference, row.visibility), 8.0 / 255);
}

TEST(HeatMap, Bar_LiesBelowTheMap_WithNumbersInIt) {
  const Comparison c = small_comparison();
  const Picture map = heat_map(c.per_vertex, c.per_fragment, c.visibility, 0);
  ASSERT_EQ(map.width, c.per_vertex.width);
  ASSERT_GT(map.height, c.per_vertex.height);
  ASSERT_EQ(map.pixels.size(), std::size_t{map.width} * map.height);
  bool has_blue = false, has_red = false, has_ink = false;
  for (std::size_t i = std::size_t{map.width} * c.per_vertex.height; i < map.pixels.size(); ++i) {
    has_blue |= to_srgb8(map.pixels[i]) == Srgb8{8, 48, 107};
    has_red |= to_srgb8(map.pixels[i]) == Srgb8{103, 0, 13};
    has_ink |= to_srgb8(map.pixels[i]) == Srgb8{236, 236, 232};
  }
  EXPECT_TRUE(has_blue && has_red && has_ink);
}

TEST(HeatMap, OnePixel_DoesNotDrawOutside) {
  EXPECT_EQ(Row({1}).map(0).width, 1U);
}

TEST(HeatMap, SizesThatDiffer_Throw) {
  const Row two({0, 0}), one({0});
  EXPECT_THROW(heat_map(two.test, one.reference, two.visibility, 0), InvalidOption);
  EXPECT_THROW(heat_map(two.test, two.reference, one.visibility, 0), InvalidOption);
}

TEST(WorstPixels, LargestFirst_ApartFromEachOther_NoneThatDoesNotShow) {
  std::vector<float> d(100, 0.0f);  // 10×10
  d[33] = 0.5f, d[34] = -0.6f, d[88] = 0.2f, d[9] = 0.5f / 255, d[50] = NAN;
  const std::vector<WorstPixel> worst = worst_pixels(d, 10, 4, 3);
  ASSERT_EQ(worst.size(), 2U);
  EXPECT_EQ(worst[0].x, 4U);
  EXPECT_EQ(worst[0].y, 3U);
  EXPECT_EQ(worst[0].difference, -0.6f);
  EXPECT_EQ(worst[1].x, 8U);
  EXPECT_EQ(worst[1].y, 8U);
  EXPECT_EQ(worst_pixels(d, 10, 1, 3).size(), 1U);
}

}  // namespace
}  // namespace lambake
