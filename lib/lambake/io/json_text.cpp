#include "lambake/io/json_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "lambake/core/error.h"

namespace lambake {
namespace {

constexpr int deepest_json = 256;

int depth_of(std::string_view text) {
  int depth = 0, deepest = 0;
  bool is_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (is_string && c == '\\') {
      ++i;
    } else if (c == '"') {
      is_string = !is_string;
    } else if (!is_string) {
      depth += (c == '[' || c == '{') - (c == ']' || c == '}');
      deepest = std::max(deepest, depth);
    }
  }
  return deepest;
}

}  // namespace

void check_depth(const std::string& path, std::string_view text) {
  if (depth_of(text) > deepest_json)
    throw IoError(path, fmt::format("expected JSON nested at most {} levels deep", deepest_json));
}

void throw_no_json(const std::string& path, const std::string& reason) {
  constexpr std::size_t longest = 300;
  // "[json.exception…] parse error at line 1, column 2: …", or another reason without a place.
  const std::size_t name_end = reason.find("] ");
  const std::string text = name_end == std::string::npos ? reason : reason.substr(name_end + 2);
  constexpr std::string_view before_place = "parse error at ";
  const std::size_t place_end = text.find(": ");
  if (!text.starts_with(before_place) || place_end == std::string::npos)
    throw IoError(path, "expected JSON: " + shortened(text, longest));
  throw IoError(path, fmt::format("{}: expected JSON: {}",
                                  text.substr(before_place.size(), place_end - before_place.size()),
                                  shortened(text.substr(place_end + 2), longest)));
}

}  // namespace lambake
