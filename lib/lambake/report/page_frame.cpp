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

std::string columns(std::initializer_list<std::string_view> names, std::string_view attributes) {
  std::string html = "<thead><tr>";
  for (const std::string_view& name : names)
    html += fmt::format("<th scope=\"col\"{}>{}</th>", &name == names.begin() ? "" : attributes, name);
  return html + "</tr></thead>\n<tbody>\n";
}

}  // namespace

std::string page_frame(const std::string& title, const std::string& header, const std::string& main) {
  const std::string css = std::string(page_assets::page_css).append(page_assets::chart_css);
  const std::string escaped_title = escape_html(title);
  return fill_slots(page_assets::page_html, {{"title", escaped_title},
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

std::string number_columns(std::initializer_list<std::string_view> names) {
  return columns(names, " class=\"n\"");
}

std::string text_columns(std::initializer_list<std::string_view> names) {
  return columns(names, "");
}

std::string row_begin(std::string_view label, std::string_view name) {
  return fmt::format("<tr><th scope=\"row\" data-label=\"{}\">{}</th>", label, name);
}

std::string number_cell(std::string_view label, std::string_view number) {
  return fmt::format("<td class=\"n\" data-label=\"{}\">{}</td>", label, number);
}

std::string bar_cell(double percent, std::string_view text) {
  return fmt::format("<td><span class=\"share\"><i style=\"width:{:.2f}%\"></i></span>{}</td>", percent,
                     text);
}

std::string count_of(std::size_t n, const char* singular, const char* plural) {
  return fmt::format("<b>{}</b> {}", grouped(n), n == 1 ? singular : plural);
}

}  // namespace lambake
