#include "lambake/core/value_numbers.h"

#include <gtest/gtest.h>

namespace lambake {
namespace {

TEST(ValueNumbers, OfManyValues_AreThoseOfTheirFirstPlaces) {
  ValueNumbers<3> numbers;
  for (int round = 0; round < 2; ++round)
    for (int i = 0; i < 30'000; ++i) {
      // Few bits of a grid's coordinates differ.
      const auto x = static_cast<float>(i % 100), y = static_cast<float>(i / 100);
      ASSERT_EQ(numbers.number_of({x, y, 0}), i);
    }
  EXPECT_EQ(numbers.size(), 30'000u);
  EXPECT_EQ(numbers.number_of({-0.0f, 0, 0}), 30'000u);  // Bit by bit.
}

}  // namespace
}  // namespace lambake
