#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
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
  std::size_t size() const { return numbers_.size(); }

 private:
  using Bits = std::array<std::uint32_t, 3>;
  struct Hash {
    std::size_t operator()(const Bits& bits) const;
  };
  std::unordered_map<Bits, std::uint32_t, Hash> numbers_;
};

}  // namespace lambake
