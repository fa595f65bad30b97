#pragma once

#include <string>

/// What the pages have in common. Internal to the folder.
namespace lambake {

/// A whole self-contained document. `title` is plain text; `header` and `main` are HTML.
std::string page_frame(const std::string& title, const std::string& header, const std::string& main);

/// The section "How this was made": the command, the version and a sentence about time (HTML).
std::string made_section(const std::string& command, const std::string& version, const std::string& time);

/// "<b>1 234</b> vertices".
std::string count_of(std::size_t n, const char* singular, const char* plural);

}  // namespace lambake
