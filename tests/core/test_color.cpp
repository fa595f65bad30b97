#include "lambake/core/color.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lambake {
namespace {

TEST(SrgbCurve, PassesThroughItsKnownPoints) {
  // IEC 61966-2-1: the ends, the joint of the two pieces, middle grey.
  EXPECT_EQ(srgb_encode(0.0), 0);
  EXPECT_DOUBLE_EQ(srgb_encode(1.0), 1);
  EXPECT_NEAR(srgb_encode(0.0031308), 0.04045, 1e-6);
  EXPECT_NEAR(srgb_encode(0.18), 0.461356, 1e-6);
  EXPECT_NEAR(srgb_decode(0.5), 0.214041, 1e-6);
}

TEST(SrgbCurve, SlopeAtBlack_Is12Point92_OnBothSides) {
  EXPECT_DOUBLE_EQ(srgb_encode(1e-3), 12.92e-3);
  EXPECT_DOUBLE_EQ(srgb_encode(-1e-3), -12.92e-3);
}

TEST(SrgbCurve, EncodeThenDecode_IsTheSame) {
  // At the joint the standard's rounded constants leave a step of 4e-8.
  for (double linear = -0.1; linear <= 4; linear += 1e-3)
    EXPECT_NEAR(srgb_decode(srgb_encode(linear)), linear, 1e-7) << linear;
}

TEST(SrgbCurve, Rises) {
  for (float linear = 0; linear < 1.0f; linear += 1e-3f)
    EXPECT_LT(srgb_encode(linear), srgb_encode(linear + 1e-3f));
}

TEST(Srgb8, EveryStep_DecodedAndEncoded_ComesBack) {
  for (int i = 0; i < 256; ++i) {
    const auto step = static_cast<std::uint8_t>(i);
    EXPECT_EQ(to_srgb8(to_linear(Srgb8{step, step, step})), (Srgb8{step, step, step}));
  }
}

TEST(Srgb8, RoundsToTheNearestStep) {
  for (int i = 0; i < 255; ++i) {
    const double border = srgb_decode((i + 0.5) / 255);
    EXPECT_EQ(srgb8_channel(static_cast<float>(border * (1 - 1e-5))), i);
    EXPECT_EQ(srgb8_channel(static_cast<float>(border * (1 + 1e-5))), i + 1);
  }
}

TEST(Srgb8, OutOfRange_IsClamped_NaNIsBlack) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(srgb8_channel(-1), 0);
  EXPECT_EQ(srgb8_channel(-inf), 0);
  EXPECT_EQ(srgb8_channel(1.5f), 255);
  EXPECT_EQ(srgb8_channel(inf), 255);
  EXPECT_EQ(srgb8_channel(std::numeric_limits<float>::quiet_NaN()), 0);
}

TEST(LinearRgb, LightTimesAlbedo_IsByChannel) {
  EXPECT_EQ((LinearRgb{1, 2, 3} * LinearRgb{0.5f, 0.25f, 2} + LinearRgb{1, 0, 0} * 2.0f),
            (LinearRgb{2.5f, 0.5f, 6}));
}

}  // namespace
}  // namespace lambake
