#include "lambake/core/digits.h"

#include <gtest/gtest.h>

#include <string>

namespace lambake {
namespace {

TEST(Digits, Bounds_AreRoundedUp_ExactOnesStay) {
  EXPECT_EQ(upper_bound_text(0), "0");
  EXPECT_EQ(upper_bound_text(255 * (1.0 / 255)), "1");
  EXPECT_EQ(upper_bound_text(1.0001), "1.01");
  EXPECT_EQ(upper_bound_text(0.9991), "1");
  EXPECT_EQ(upper_bound_text(0.99801), "0.999");
  EXPECT_EQ(upper_bound_text(90.71), "90.8");
  EXPECT_EQ(upper_bound_text(126.2), "127");
  for (double x = 1e-12; x < 1e4; x *= 1.37) EXPECT_GE(std::stod(upper_bound_text(x)), x * (1 - 2e-9)) << x;
  EXPECT_EQ(round_up(2.31, 1), 2.4);
}

TEST(Digits, Groups_OfThree) {
  EXPECT_EQ(group_digits(0), "0");
  EXPECT_EQ(group_digits(999), "999");
  EXPECT_EQ(group_digits(1234567), "1,234,567");
}

}  // namespace
}  // namespace lambake
