#include "lambake/report/timing.h"

#include <algorithm>
#include <chrono>
#include <vector>

namespace lambake {
namespace {

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Of sorted values, between the two nearest.
double quantile(const std::vector<double>& sorted, double q) {
  const double at = q * static_cast<double>(sorted.size() - 1);
  const auto i = static_cast<std::size_t>(at);
  return i + 1 < sorted.size() ? sorted[i] + (at - static_cast<double>(i)) * (sorted[i + 1] - sorted[i])
                               : sorted[i];
}

}  // namespace

Timing measure_time(const std::function<void()>& work, double seconds) {
  const double warm_up = seconds_of(work);
  if (warm_up > seconds) return {warm_up, warm_up, warm_up, 1};
  std::vector<double> sorted;
  Timing timing;
  for (double spent = warm_up; sorted.size() < 101;) {
    const double t = seconds_of(work);
    spent += t;
    sorted.insert(std::upper_bound(sorted.begin(), sorted.end(), t), t);
    timing = {quantile(sorted, 0.5), quantile(sorted, 0.25), quantile(sorted, 0.75), sorted.size()};
    const bool is_steady = timing.high - timing.low <= 0.1 * timing.median;
    if (sorted.size() >= 3 && (spent >= seconds || (is_steady && sorted.size() >= 7))) break;
  }
  return timing;
}

}  // namespace lambake
