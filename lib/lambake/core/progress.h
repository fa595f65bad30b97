#pragma once

#include <functional>
#include <string_view>

namespace lambake {

/// Told by long work: the stage's name and how much of it is done, in [0,1]. May be empty. Called from
/// one thread at a time.
using Progress = std::function<void(std::string_view stage, double fraction)>;

inline void report_progress(const Progress& progress, std::string_view stage, double fraction) {
  if (progress) progress(stage, fraction);
}

}  // namespace lambake
