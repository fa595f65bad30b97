#include "console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace lambake::tool {

Console::Console(bool is_quiet)
    : is_quiet_(is_quiet),
      is_terminal_(::isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()) {}

void Console::note(const std::string& text) {
  if (is_quiet_) return;
  clear_bar();
  fmt::print(stderr, "lambake: {}\n", text);
}

void Console::tell(const Findings& findings) {
  for (const Finding& f : findings) note(fmt::format("{} {}", group_digits(f.count), f.text));
}

Progress Console::progress() {
  if (is_quiet_ || !is_terminal_) return {};
  return [this](std::string_view stage, double fraction) {
    if (std::chrono::steady_clock::now() - start_ < std::chrono::seconds(1)) return;
    constexpr int width = 30;
    const int filled = std::clamp(static_cast<int>(fraction * width), 0, width);
    fmt::print(stderr, "\r\x1b[K{:<22} [{:#<{}}{:<{}}] {:3.0f}%", stage, "", filled, "", width - filled,
               100 * fraction);
    std::fflush(stderr);
    has_bar_ = true;
  };
}

void Console::clear_bar() {
  if (!has_bar_) return;
  fmt::print(stderr, "\r\x1b[K");
  has_bar_ = false;
}

void Stopwatch::lap(const std::string& stage) {
  const auto now = std::chrono::steady_clock::now();
  seconds_.emplace_back(stage, std::chrono::duration<double>(now - last_).count());
  last_ = now;
}

std::string group_digits(std::size_t n) {
  std::string digits = std::to_string(n);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, 1, ',');
  return digits;
}

}  // namespace lambake::tool
