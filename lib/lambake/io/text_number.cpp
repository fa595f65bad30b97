#include "lambake/io/text_number.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string_view>
#include <system_error>

namespace lambake {
namespace {

/// Length of the zeros and the exponent at the front.
std::size_t length_of_padding(std::string_view text) {
  constexpr std::string_view digits = "0123456789";
  const std::size_t zeros = std::min(text.find_first_not_of('0'), text.size());
  std::string_view exponent = text.substr(zeros);
  if (!exponent.starts_with('e') && !exponent.starts_with('E')) return zeros;
  exponent.remove_prefix(1);
  const std::size_t sign = exponent.starts_with('+') || exponent.starts_with('-') ? 1 : 0;
  exponent.remove_prefix(sign);
  const std::size_t n_digits = std::min(exponent.find_first_not_of(digits), exponent.size());
  return n_digits == 0 ? zeros : zeros + 1 + sign + n_digits;
}

bool is_in_word(char c) {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_';
}

}  // namespace

std::from_chars_result microsoft_from_chars(const char* begin, const char* end, float& value) {
  std::string_view text(begin, static_cast<std::size_t>(end - begin));
  const bool is_negative = text.starts_with('-');
  if (is_negative) text.remove_prefix(1);
  constexpr std::string_view front = "1.#", infinity = "INF";
  if (text.starts_with(front)) {
    text.remove_prefix(front.size());
    // The first is infinite, those behind SNAN are rounded.
    constexpr std::string_view names[] = {infinity, "IND", "QNAN", "SNAN", "QNB", "SNB",
                                          "QO",     "SO",  "IO",   "J",    "R",   "T"};
    for (const std::string_view name : names) {
      if (!text.starts_with(name)) continue;
      const std::string_view rest = text.substr(name.size());
      const std::size_t padding = length_of_padding(rest);
      if (padding < rest.size() && is_in_word(rest[padding])) continue;  // "1.#Top": a comment.
      using Limits = std::numeric_limits<float>;
      value = name == infinity ? Limits::infinity() : Limits::quiet_NaN();
      if (is_negative) value = -value;
      return {rest.data() + padding, std::errc()};
    }
  }
  return {begin, std::errc::invalid_argument};
}

}  // namespace lambake
