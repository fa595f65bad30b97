#include "lambake/report/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "lambake/core/digits.h"
#include "lambake/core/utf8.h"

namespace lambake {

std::string escape_html(std::string_view text) {
  constexpr std::string_view replacement = "\xEF\xBF\xBD";
  std::string out;
  out.reserve(text.size() + text.size() / 8);
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const char c = text.front();
    if (length == 0 || c == 0x7F || (c >= 0 && c < 0x20 && c != '\n' && c != '\t')) {
      out += replacement;
    } else if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else if (c == '\'') {
      out += "&#39;";
    } else {
      out += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j)
      group = group << 8 | (i + j < bytes.size() ? static_cast<std::uint8_t>(bytes[i + j]) : 0U);
    for (std::size_t j = 0; j < 4; ++j)
      out += i + j <= bytes.size() ? alphabet[group >> (18 - 6 * j) & 63] : '=';
  }
  return out;
}

std::string grouped(std::size_t number) {
  std::string digits = std::to_string(number);
  for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(digits.size()) - 3; i > 0; i -= 3)
    digits.insert(static_cast<std::size_t>(i), "\u202F");
  return digits;
}

std::string short_number(double number) {
  if (std::isnan(number)) return "not a number";
  if (std::isinf(number)) return number > 0 ? "∞" : "−∞";
  const std::string sign = number < 0 ? "−" : "";
  const double size = std::abs(number);
  if (size == 0) return "0";
  if (size >= 1e4 && size < 1e15) return sign + grouped(static_cast<std::size_t>(std::llround(size)));
  if (size < 1e-3 || size >= 1e15) return sign + fmt::format("{:.2g}", size);
  const int decimals = std::max(0, 2 - static_cast<int>(std::floor(std::log10(size))));
  std::string text = fmt::format("{:.{}f}", size, decimals);
  if (text.find('.') != std::string::npos) {
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
  }
  return sign + text;
}

std::string short_bound(double bound) {
  if (!(bound > 0) || !std::isfinite(bound)) return short_number(bound);
  const int n_digits = bound < 1e-3 ? 2 : 3;
  return short_number(
      round_up(bound, std::max(0, n_digits - 1 - static_cast<int>(std::floor(std::log10(bound))))));
}

std::string steps_of_255(double value) {
  const double steps = value * 255;
  if (!std::isfinite(steps) || steps == 0) return short_number(steps);
  if (std::abs(steps) < 0.005) return "< 0.01/255";
  return short_number(steps) + "/255";
}

std::string bound_of_255(double bound) {
  const double steps = bound * 255;
  if (!std::isfinite(steps) || steps < 0.005) return steps_of_255(bound);
  return short_bound(steps) + "/255";
}

std::string percent(double share) {
  if (share > 0 && share < 0.0001) return "< 0.01 %";
  return fmt::format("{} %", short_number(share * 100));
}

std::string duration(double seconds) {
  if (seconds < 1e-3) return short_number(std::round(seconds * 1e7) / 10) + " µs";
  if (seconds < 1) return short_number(seconds * 1e3) + " ms";
  return short_number(seconds) + " s";
}

}  // namespace lambake
