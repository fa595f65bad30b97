#pragma once

#include <cstddef>

namespace lambake {

/// The most bytes that anything in this executable asked for at once since the last reset.
std::size_t largest_allocation();
void reset_largest_allocation();

/// The most bytes that were allocated at a time since the last reset, beyond those that were then.
std::size_t peak_of_allocations();
void reset_peak_of_allocations();

}  // namespace lambake
