#include "lambake/report/page_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "lambake/report/page_assets.h"
#include "lambake/report/text.h"

namespace lambake {
namespace {

/// `text` with each {{name}} replaced by its value. Values are not looked at again.
std::string fill_slots(std::string_view text,
                       const std::vector<std::pair<std::string_view, std::string_view>>& slots) {
  std::string out;
  while (true) {
    const std::size_t open = text.find("{{");
    if (open == std::string_view::npos) return out.append(text);
    const std::size_t close = text.find("}}", open);
    const std::string_view name = text.substr(open + 2, close - open - 2);
    out.append(text.substr(0, open));
    out.append(
        std::find_if(slots.begin(), slots.end(), [&](const auto& s) { return s.first == name; })->second);
    text.remove_prefix(close + 2);
  }
}

}  // namespace

std::string page_frame(const std::string& command, const std::string& title, const std::string& header,
                       const std::string& main) {
  const std::string css = std::string(page_assets::page_css).append(page_assets::chart_css);
  const std::string escaped_title = escape_html(title + " · lambake " + command);
  return fill_slots(page_assets::page_html, {{"command", command},
                                             {"title", escaped_title},
                                             {"css", css},
                                             {"js", page_assets::page_js},
                                             {"header", header},
                                             {"main", main}});
}

std::string made_section(const std::string& command, const std::string& version, const std::string& time) {
  std::string html = section_begin("made", "How this was made") + "<dl class=\"made\">\n";
  const auto row = [&](const char* name, const std::string& value) {
    html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", name, value);
  };
  row("Command", "<code>" + escape_html(command) + "</code>");
  row("Version", "lambake " + escape_html(version));
  if (!time.empty()) row("Time", time);
  return html + "</dl>\n</section>\n";
}

std::string section_begin(std::string_view id, std::string_view heading) {
  return fmt::format("<section aria-labelledby=\"{0}\">\n<h2 id=\"{0}\">{1}</h2>\n", id, heading);
}

std::string table_head(std::initializer_list<Column> columns, CellKind kind) {
  std::string html = "<thead><tr>";
  for (const Column& column : columns)
    html += fmt::format("<th scope=\"col\"{}>{}</th>",
                        kind == CellKind::number && &column != columns.begin() ? " class=\"n\"" : "",
                        column.head);
  return html + "</tr></thead>\n<tbody>\n";
}

std::string stacked_table(std::initializer_list<Column> columns, CellKind kind,
                          const std::vector<std::vector<std::string>>& rows) {
  std::string html = "<table class=\"table stacked\">\n" + table_head(columns, kind);
  for (const std::vector<std::string>& row : rows) {
    html += fmt::format("<tr><th scope=\"row\" data-label=\"{}\">{}</th>", columns.begin()->label, row[0]);
    for (std::size_t c = 1; c < row.size(); ++c)
      html += fmt::format("<td{} data-label=\"{}\">{}</td>", kind == CellKind::number ? " class=\"n\"" : "",
                          columns.begin()[c].label, row[c]);
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table>\n";
}

std::string bar_cell(double percent, std::string_view text) {
  return fmt::format("<td><span class=\"share\"><i style=\"width:{:.2f}%\"></i></span>{}</td>", percent,
                     text);
}

std::string count_of(std::size_t n, const char* singular, const char* plural) {
  return fmt::format("<b>{}</b> {}", grouped(n), n == 1 ? singular : plural);
}

}  // namespace lambake
