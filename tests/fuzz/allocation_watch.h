#pragma once

#include <cstddef>

namespace lambake {

/// The most bytes that anything in this executable asked for at once since the last reset.
std::size_t largest_allocation();
void reset_largest_allocation();

}  // namespace lambake
