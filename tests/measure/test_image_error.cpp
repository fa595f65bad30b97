#include "lambake/measure/image_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lambake/core/error.h"

namespace lambake {
namespace {

Picture grey(std::uint32_t width, std::uint32_t height, float value) {
  return {width, height, std::vector<LinearRgb>(std::size_t{width} * height, {value, value, value})};
}

/// Every pixel covered.
Visibility covered(std::uint32_t width, std::uint32_t height) {
  Visibility v;
  v.width = width;
  v.height = height;
  v.triangles.assign(std::size_t{width} * height, 0);
  v.n_covered = v.triangles.size();
  return v;
}

TEST(ComparePictures, Identical_IsZeroEverywhere) {
  for (const ErrorSpace space : {ErrorSpace::linear, ErrorSpace::display}) {
    const ImageError error = compare_pictures(grey(4, 3, 0.3f), grey(4, 3, 0.3f), covered(4, 3), space);
    EXPECT_EQ(error.rmse, 0);
    EXPECT_EQ(error.mae, 0);
    EXPECT_EQ(error.max, 0);
    EXPECT_EQ(error.p99, 0);
    EXPECT_EQ(error.psnr_db, std::numeric_limits<double>::infinity());
    EXPECT_EQ(error.pixels, 12u);
    EXPECT_EQ(error.pixels_over_1_255, 0u);
    EXPECT_EQ(error.histogram[0], 12u);
  }
}

TEST(ComparePictures, OneOfNValuesOffByD_GivesDOverRootN) {
  Picture test = grey(5, 4, 0.5f);
  test.pixels[13].g -= 0.25f;
  const ImageError error = compare_pictures(test, grey(5, 4, 0.5f), covered(5, 4), ErrorSpace::linear);
  EXPECT_DOUBLE_EQ(error.rmse, 0.25 / std::sqrt(60.0));
  EXPECT_DOUBLE_EQ(error.mae, 0.25 / 60);
  EXPECT_DOUBLE_EQ(error.mean, -0.25 / 60);
  EXPECT_DOUBLE_EQ(error.max, 0.25);
  EXPECT_EQ(error.max_x, 3u);
  EXPECT_EQ(error.max_y, 2u);
  EXPECT_DOUBLE_EQ(error.psnr_db, 20 * std::log10(std::sqrt(60.0) / 0.25));
  EXPECT_EQ(error.pixels_over_1_255, 1u);
  EXPECT_EQ(error.histogram[0], 19u);
  EXPECT_EQ(error.histogram[64], 1u);  // 0.25·255 = 63.75
}

TEST(ComparePictures, OnScreen_IsMeasuredOnTheClampedCurve) {
  const ImageError dark =
      compare_pictures(grey(2, 2, 0.001f), grey(2, 2, 0), covered(2, 2), ErrorSpace::display);
  EXPECT_NEAR(dark.max, 0.01292, 1e-8);  // the curve's slope at black is 12.92
  const ImageError bright =
      compare_pictures(grey(2, 2, 7), grey(2, 2, 1), covered(2, 2), ErrorSpace::display);
  EXPECT_EQ(bright.max, 0);
}

TEST(ComparePictures, UncoveredPixels_DoNotCount) {
  Visibility visibility = covered(2, 1);
  visibility.triangles[1] = no_triangle;
  Picture test = grey(2, 1, 0.5f);
  test.pixels[1] = {9, 9, 9};
  const ImageError error = compare_pictures(test, grey(2, 1, 0.5f), visibility, ErrorSpace::linear);
  EXPECT_EQ(error.max, 0);
  EXPECT_EQ(error.pixels, 1u);
}

TEST(ComparePictures, NaNAndInfinity_AreCountedAndLeftOut) {
  Picture test = grey(2, 2, 0.5f), reference = grey(2, 2, 0.5f);
  test.pixels[0].r = std::numeric_limits<float>::quiet_NaN();
  reference.pixels[3].b = std::numeric_limits<float>::infinity();
  test.pixels[2].g = 1.0f;
  const ImageError error = compare_pictures(test, reference, covered(2, 2), ErrorSpace::linear);
  EXPECT_EQ(error.nonfinite, 2u);
  EXPECT_DOUBLE_EQ(error.rmse, 0.5 / std::sqrt(10.0));
  EXPECT_EQ(error.pixels, 4u);
}

TEST(ComparePictures, HundredPixels_P99IsExceededByOneAtMost) {
  Picture test = grey(100, 1, 0);
  for (std::size_t i = 0; i < 100; ++i) test.pixels[i].r = float(i) / 128;
  const ImageError error = compare_pictures(test, grey(100, 1, 0), covered(100, 1), ErrorSpace::linear);
  EXPECT_DOUBLE_EQ(error.p99, 98.0 / 128);
  EXPECT_DOUBLE_EQ(error.max, 99.0 / 128);
}

TEST(ComparePictures, SizesThatDiffer_Throw) {
  EXPECT_THROW(compare_pictures(grey(2, 3, 0), grey(3, 2, 0), covered(2, 3), ErrorSpace::linear),
               InvalidOption);
  EXPECT_THROW(compare_pictures(grey(3, 2, 0), grey(2, 3, 0), covered(2, 3), ErrorSpace::linear),
               InvalidOption);
  EXPECT_THROW(compare_pictures(grey(2, 2, 0), grey(2, 2, 0), covered(2, 3), ErrorSpace::linear),
               InvalidOption);
}

TEST(CombineImageErrors, HalvesOfAPicture_AreTheWhole) {
  Picture test = grey(4, 2, 0.5f);
  for (std::size_t i = 0; i < 8; ++i) test.pixels[i].b += 0.01f * float(i * i);
  test.pixels[6].r = std::numeric_limits<float>::quiet_NaN();
  const Picture reference = grey(4, 2, 0.5f);
  const auto part = [&](std::size_t begin, std::uint32_t rows) {
    const auto cut = [&](const Picture& p) {
      return Picture{4, rows, {p.pixels.begin() + long(begin), p.pixels.begin() + long(begin + 4 * rows)}};
    };
    return compare_pictures(cut(test), cut(reference), covered(4, rows), ErrorSpace::linear);
  };
  const ImageError whole = part(0, 2), both = combine({part(0, 1), part(4, 1)});
  EXPECT_NEAR(both.rmse, whole.rmse, 1e-15);
  EXPECT_NEAR(both.mae, whole.mae, 1e-15);
  EXPECT_NEAR(both.mean, whole.mean, 1e-15);
  EXPECT_NEAR(both.psnr_db, whole.psnr_db, 1e-12);
  EXPECT_EQ(both.max, whole.max);
  EXPECT_EQ(both.pixels, whole.pixels);
  EXPECT_EQ(both.pixels_over_1_255, whole.pixels_over_1_255);
  EXPECT_EQ(both.nonfinite, 1u);
  EXPECT_EQ(both.histogram, whole.histogram);
}

TEST(CombineErrors, LargestError_IsOfItsViewAndPixel) {
  ImageError near, far;
  near.max = 0.25, near.max_x = 3, near.max_y = 4;
  far.max = 0.5, far.max_x = 7, far.max_y = 1;
  const ImageError all = combine({near, far, near});
  EXPECT_EQ(all.max_view, 1U);
  EXPECT_EQ(all.max_x, 7U);
  EXPECT_EQ(all.max_y, 1U);
}

}  // namespace
}  // namespace lambake
