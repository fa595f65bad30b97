#pragma once

#include <cstdint>

namespace lambake {

/// `hash` with one more word in it.
constexpr std::uint64_t mixed(std::uint64_t hash, std::uint32_t word) {
  hash = (hash ^ word) * 0x9E3779B97F4A7C15U;
  return hash ^ hash >> 32;
}

}  // namespace lambake
