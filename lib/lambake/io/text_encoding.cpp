#include "lambake/io/text_encoding.h"

#include <algorithm>
#include <cstddef>

#include "lambake/core/error.h"

namespace lambake {
namespace {

/// @param zero  where the zeros of the characters are: 0 before the letter, 1 behind it.
bool is_half_zeros(std::string_view text, std::size_t zero) {
  constexpr std::size_t least_size = 4, most_searched = 8;
  if (text.size() < least_size) return false;
  for (std::size_t i = 0; i < std::min(text.size(), most_searched); ++i)
    if ((text[i] == '\0') != (i % 2 == zero)) return false;
  return true;
}

}  // namespace

std::string_view as_utf8(const std::string& path, std::string_view text) {
  if (text.starts_with("\xFE\xFF") || text.starts_with("\xFF\xFE") || is_half_zeros(text, 0) ||
      is_half_zeros(text, 1))
    throw IoError(path, "expected text in UTF-8, found UTF-16");
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

}  // namespace lambake
