#pragma once

#include <chrono>

namespace lambake {

/// When a bake has to end; internal to the folder. It runs from its making.
class Deadline {
 public:
  /// @param max_seconds  0 or less is no limit.
  explicit Deadline(double max_seconds) : max_seconds_(max_seconds) {}

  bool is_past() const {
    if (max_seconds_ <= 0) return false;
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
    return elapsed.count() > max_seconds_;
  }

 private:
  double max_seconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace lambake
