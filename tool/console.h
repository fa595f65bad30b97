#pragma once

#include <fmt/format.h>

#include <chrono>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "lambake/core/finding.h"
#include "lambake/core/progress.h"

namespace lambake::tool {

/// Text on one line, whatever names of files and materials hold: control characters as \xNN.
std::string on_one_line(const std::string& text);

/// Writes to standard error. What is lost there is lost: nowhere is left to tell it.
void print_error(const std::string& text);

/// Writes to standard output. @throws IoError.
void write_result(const std::string& text);

template <typename... Values>
void print_result(fmt::format_string<Values...> format, Values&&... values) {
  write_result(fmt::format(format, std::forward<Values>(values)...));
}

/// Writes what standard output holds back. @throws IoError.
void flush_results();

/// What the tool says to people, all of it on standard error; standard output is for results.
class Console {
 public:
  explicit Console(bool is_quiet);

  /// One line, prefixed by "lambake: ". Nothing with --quiet.
  void note(const std::string& text);
  /// One line per finding.
  void tell(const Findings& findings);
  /// Names the work that begins now. Once a stage has lasted a second, a bar shows it; on a terminal only.
  void stage(const std::string& name);
  /// For work that knows how far it is.
  Progress progress();
  /// Removes the bar, before results are printed.
  void clear_bar();

 private:
  void draw_bar();
  void remove_bar();

  bool is_quiet_ = false;
  std::mutex mutex_;  ///< Of all below.
  std::string stage_;
  double fraction_ = -1;  ///< Below 0: not known.
  bool has_bar_ = false;
  std::chrono::steady_clock::time_point stage_start_;
  std::jthread ticker_;  ///< Draws the bar; last, so that it ends before what it reads.
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

}  // namespace lambake::tool
