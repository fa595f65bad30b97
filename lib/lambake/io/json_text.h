#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

/// JSON of files that anybody may have made, and what messages show of it; internal to io.
namespace lambake {

/// Text from a file in a message: cut where it is longer.
inline std::string shortened(std::string text, std::size_t longest) {
  if (text.size() > longest) text = text.substr(0, longest) + "…";
  return text;
}

/// A value in a message, in ASCII.
template <typename Json>
std::string shown(const Json& value) {
  constexpr std::size_t longest = 60;
  return shortened(value.dump(-1, ' ', true), longest);
}

/// Refuses text whose arrays and objects lie in each other more than 256 deep: what reads and writes JSON
/// goes by recursion. Before it is parsed, as the parser tells depths only at the price of quadratic time.
/// @throws IoError.
void check_depth(const std::string& path, std::string_view text);

/// The error for text that is no JSON. @param reason  nlohmann's, from which its place is taken; may hold a
/// megabyte of data.
[[noreturn]] void throw_no_json(const std::string& path, const std::string& reason);

}  // namespace lambake
