#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>

/// What the pages have in common. Internal to the folder.
namespace lambake {

/// A whole self-contained document. `title` is plain text; `header` and `main` are HTML.
std::string page_frame(const std::string& title, const std::string& header, const std::string& main);

/// The section "How this was made": the command, the version and a sentence about time (HTML).
std::string made_section(const std::string& command, const std::string& version, const std::string& time);

/// A section up to its heading (HTML), which names it.
std::string section_begin(std::string_view id, std::string_view heading);

/// The head of a table and the beginning of its body. The first column names the rows; the others hold
/// numbers, or text.
std::string number_columns(std::initializer_list<std::string_view> names);
std::string text_columns(std::initializer_list<std::string_view> names);

/// Cells (HTML) of a table of the class "stacked": narrow windows show the label beside each. The first one
/// begins a row and names it.
std::string row_begin(std::string_view label, std::string_view name);
std::string number_cell(std::string_view label, std::string_view number);

/// A cell with a bar, `percent` of the width long, and a text.
std::string bar_cell(double percent, std::string_view text);

/// "<b>1 234</b> vertices".
std::string count_of(std::size_t n, const char* singular, const char* plural);

}  // namespace lambake
