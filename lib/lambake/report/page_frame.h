#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

/// What the pages have in common. Internal to the folder.
namespace lambake {

/// A whole self-contained document, as `command` makes them. `title` is plain text and stands before the name
/// of that; `header` and `main` are HTML.
std::string page_frame(const std::string& command, const std::string& title, const std::string& header,
                       const std::string& main);

/// The section "How this was made": the command, the version and a sentence about time (HTML).
std::string made_section(const std::string& command, const std::string& version, const std::string& time);

/// A section up to its heading (HTML), which names it.
std::string section_begin(std::string_view id, std::string_view heading);

/// A column of a table.
struct Column {
  std::string_view head, label;  ///< The label stands beside each cell where a narrow window stacks them.

  Column(const char* text) : head(text), label(text) {}
  Column(const char* h, const char* l) : head(h), label(l) {}
};
enum class CellKind { text, number };

/// The head of a table and the beginning of its body; the first column names the rows, the others are of a
/// kind.
std::string table_head(std::initializer_list<Column> columns, CellKind kind);

/// A table that narrow windows stack.
/// @param rows  as many cells (HTML) in each as there are columns.
std::string stacked_table(std::initializer_list<Column> columns, CellKind kind,
                          const std::vector<std::vector<std::string>>& rows);

/// A cell with a bar, `percent` of the width long, and a text.
std::string bar_cell(double percent, std::string_view text);

/// "<b>1 234</b> vertices".
std::string count_of(std::size_t n, const char* singular, const char* plural);

}  // namespace lambake
