#pragma once

#include <string>
#include <string_view>

namespace lambake {

/// The text of a file without the three bytes that some programs put in front of UTF-8. The bytes behind them
/// may be no UTF-8: names in older files are Latin-1.
/// @throws IoError if it is UTF-16: begins with the mark of that, or has a 0 beside each of its first
/// letters.
std::string_view as_utf8(const std::string& path, std::string_view text);

}  // namespace lambake
