#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lambake/core/hash.h"

namespace lambake {

/// Numbers for rows of N values, 0, 1, … in the order in which they are first met; equal rows get the same.
/// They are compared bit by bit: where −0 is to equal 0, add 0.
template <std::size_t N>
class ValueNumbers {
 public:
  std::uint32_t number_of(const std::array<float, N>& values) {
    if (4 * rows_.size() >= 3 * slots_.size()) grow();
    const auto row = std::bit_cast<Row>(values);
    std::uint32_t& number = slots_[slot_of(row)];
    if (number == none) {
      number = static_cast<std::uint32_t>(rows_.size());
      rows_.push_back(row);
    }
    return number;
  }
  std::size_t size() const { return rows_.size(); }
  /// Memory for `n` different rows, so that no more is needed for a moment while there come to be as many.
  void reserve(std::size_t n) { rows_.reserve(n); }

 private:
  using Row = std::array<std::uint32_t, N>;
  static constexpr std::uint32_t none = 0xffffffffU;

  /// Where the number of a row stands in `slots_`, or is to stand.
  std::size_t slot_of(const Row& row) const {
    std::uint64_t hash = 0;
    for (const std::uint32_t word : row) hash = mixed(hash, word);
    std::size_t slot = mixed(hash, 0) >> shift_;
    while (slots_[slot] != none && rows_[slots_[slot]] != row) slot = (slot + 1) & (slots_.size() - 1);
    return slot;
  }
  void grow() {
    const std::size_t n = std::max<std::size_t>(16, 2 * slots_.size());
    shift_ = 64 - std::countr_zero(n);
    std::vector<std::uint32_t>().swap(slots_);
    slots_.resize(n, none);
    for (std::uint32_t i = 0; i < rows_.size(); ++i) slots_[slot_of(rows_[i])] = i;
  }

  std::vector<Row> rows_;             // By their number.
  std::vector<std::uint32_t> slots_;  // A power of two, at most three quarters taken.
  int shift_ = 64;                    // 64 - the logarithm of their number.
};

}  // namespace lambake
