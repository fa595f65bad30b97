#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lambake/core/color.h"
#include "lambake/core/finding.h"

namespace lambake {

/// Colours as a mesh file has them, sRGB-encoded in [0,1], made linear in place. Not finite becomes white,
/// outside of [0,1] is clamped, and where a channel is above 2 the file is taken to count to 255; each is
/// counted.
void decode_file_colors(std::vector<LinearRgb>& colors, Findings& findings);

/// Numbers for triples of values, 0, 1, … in the order in which they are first met; equal ones (bit by bit)
/// get the same.
class ValueNumbers {
 public:
  std::uint32_t number_of(float a, float b, float c);
  std::size_t size() const { return values_.size(); }

 private:
  using Bits = std::array<std::uint32_t, 3>;
  /// Where the number of a value stands in `slots_`, or is to stand.
  std::size_t slot_of(const Bits& bits) const;
  void grow();

  std::vector<Bits> values_;          // By their number.
  std::vector<std::uint32_t> slots_;  // A power of two, at most three quarters taken.
  int shift_ = 64;                    // 64 - the logarithm of their number.
};

}  // namespace lambake
