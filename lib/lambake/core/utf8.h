#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace lambake {

/// Length of the UTF-8 character at the front (RFC 3629: no surrogates, no overlong forms), or 0 if there is
/// none. @param text  not empty.
std::size_t utf8_length(std::string_view text);

/// A name of a file as UTF-8: bytes that are none are taken for Latin-1, which older programs write.
std::string utf8_of(std::string_view name);

}  // namespace lambake
