#pragma once

#include <cstddef>
#include <functional>

namespace lambake {

/// Wall time of a piece of work that was repeated.
struct Timing {
  double median = 0;         ///< Seconds.
  double low = 0, high = 0;  ///< The quartiles: half of the repeats lie between them.
  std::size_t repeats = 0;   ///< Without the warm-up.
};

/// Runs `work` once to warm up, then repeatedly: at least 3 times, until `seconds` have passed, or the
/// quartiles of at least 7 repeats are within a tenth of the median of each other, or 101 repeats are done.
/// Work that takes longer than `seconds` is run once: what warms up is small beside it.
Timing measure_time(const std::function<void()>& work, double seconds);

}  // namespace lambake
