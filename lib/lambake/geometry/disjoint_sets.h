#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace lambake {

/// Sets of the numbers below n, at first of one each.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parents_(n) { std::iota(parents_.begin(), parents_.end(), 0U); }
  /// The smallest number of the set that `i` is in, in whatever order it was put together.
  std::uint32_t find(std::uint32_t i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parents_;
};

}  // namespace lambake
