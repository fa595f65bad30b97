#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "lambake/core/finding.h"
#include "lambake/core/progress.h"

namespace lambake::tool {

/// What the tool says to people, all of it on standard error; standard output is for results.
class Console {
 public:
  explicit Console(bool is_quiet);

  /// One line, prefixed by "lambake: ". Nothing with --quiet.
  void note(const std::string& text);
  /// One line per finding.
  void tell(const Findings& findings);
  /// Draws a bar once the work has lasted a second, on a terminal only.
  Progress progress();
  /// Removes the bar, if there is one.
  void clear_bar();

 private:
  bool is_quiet_ = false;
  bool is_terminal_ = false;
  bool has_bar_ = false;
  std::chrono::steady_clock::time_point start_;
};

/// Wall-clock seconds of the stages of a command, in order.
class Stopwatch {
 public:
  Stopwatch() : last_(std::chrono::steady_clock::now()) {}
  /// Ends the running stage and calls it `stage`.
  void lap(const std::string& stage);
  const std::vector<std::pair<std::string, double>>& seconds() const { return seconds_; }

 private:
  std::chrono::steady_clock::time_point last_;
  std::vector<std::pair<std::string, double>> seconds_;
};

/// 1234567 as "1,234,567".
std::string group_digits(std::size_t n);

}  // namespace lambake::tool
