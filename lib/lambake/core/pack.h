#pragma once

#include <array>
#include <cstdint>

namespace lambake {

/// For each set of lanes, a bit for each, the numbers of those lanes and then zeros.
inline constexpr std::array<std::array<std::uint32_t, 8>, 256> packed_lanes = [] {
  std::array<std::array<std::uint32_t, 8>, 256> lanes{};
  for (std::uint32_t set = 0; set < 256; ++set)
    for (std::uint32_t lane = 0, n = 0; lane < 8; ++lane)
      if ((set >> lane & 1u) != 0) lanes[set][n++] = lane;
  return lanes;
}();

}  // namespace lambake
