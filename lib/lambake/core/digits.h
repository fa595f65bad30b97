#pragma once

#include <cstddef>
#include <string>

namespace lambake {

/// 1234567 as "1,234,567".
inline std::string group_digits(std::size_t n) {
  std::string digits = std::to_string(n);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, 1, ',');
  return digits;
}

}  // namespace lambake
