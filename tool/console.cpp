#include "console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "lambake/core/digits.h"
#include "lambake/core/error.h"

namespace lambake::tool {

std::string on_one_line(const std::string& text) {
  std::string line;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    line += byte < 0x20 || byte == 0x7F ? fmt::format("\\x{:02X}", byte) : std::string(1, c);
  }
  return line;
}

void print_error(const std::string& text) {
  std::fputs(text.c_str(), stderr);
}

namespace {

[[noreturn]] void throw_lost_result() {
  throw IoError("standard output", std::string("cannot be written: ") + std::strerror(errno));
}

}  // namespace

void write_result(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) throw_lost_result();
}

void flush_results() {
  if (std::fflush(stdout) != 0) throw_lost_result();
}

Console::Console(bool is_quiet) : is_quiet_(is_quiet) {
  if (is_quiet || ::isatty(STDERR_FILENO) != 1) return;
  ticker_ = std::jthread([this](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      const std::lock_guard lock(mutex_);
      draw_bar();
    }
    const std::lock_guard lock(mutex_);
    remove_bar();
  });
}

void Console::note(const std::string& text) {
  if (is_quiet_) return;
  const std::lock_guard lock(mutex_);
  remove_bar();
  print_error(fmt::format("lambake: {}\n", on_one_line(text)));
}

void Console::tell(const Findings& findings) {
  for (const Finding& f : findings) note(fmt::format("{} {}", group_digits(f.count), f.text));
}

void Console::stage(const std::string& name) {
  const std::lock_guard lock(mutex_);
  remove_bar();
  stage_ = name;
  fraction_ = -1;
  stage_start_ = std::chrono::steady_clock::now();
}

Progress Console::progress() {
  return [this](std::string_view stage, double fraction) {
    const std::lock_guard lock(mutex_);
    stage_ = stage;
    fraction_ = fraction;
  };
}

void Console::clear_bar() {
  stage("");
}

void Console::draw_bar() {
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - stage_start_).count();
  if (stage_.empty() || seconds < 1) return;
  constexpr int width = 30;
  if (fraction_ < 0) {  // Not known: a mark that moves.
    const int at = static_cast<int>(seconds * 10) % width;
    print_error(fmt::format("\r\x1b[K{:<20} [{:>{}}{:<{}}] {:.0f} s", stage_, '#', at + 1, "", width - at - 1,
                            seconds));
  } else {
    const int filled = std::clamp(static_cast<int>(fraction_ * width), 0, width);
    print_error(fmt::format("\r\x1b[K{:<20} [{:#<{}}{:<{}}] {:3.0f} %", stage_, "", filled, "",
                            width - filled, 100 * fraction_));
  }
  std::fflush(stderr);
  has_bar_ = true;
}

void Console::remove_bar() {
  if (!has_bar_) return;
  print_error("\r\x1b[K");
  std::fflush(stderr);
  has_bar_ = false;
}

void Stopwatch::lap(const std::string& stage) {
  const auto now = std::chrono::steady_clock::now();
  seconds_.emplace_back(stage, std::chrono::duration<double>(now - last_).count());
  last_ = now;
}

}  // namespace lambake::tool
