#pragma once

#include <fmt/format.h>

#include <fstream>
#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <vector>

/// Lines, fills and words as SVG, for the figures of the docs.
namespace lambake {

/// An SVG that follows the reader's light or dark scheme. Classes: a, b, c colours of lines; d dashed; f, g
/// fills; t text.
class Drawing {
 public:
  Drawing(double width, double height, const std::string& title)
      : text_(fmt::format(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
            "role=\"img\" "
            "aria-label=\"{2}\">\n<style>\n"
            "svg {{ --paper: #fbfaf7; --ink: #1b1c20; --soft: #55575e; --grid: #dcdad3; --a: #0a5a9c; --b: "
            "#b8442a; --c: "
            "#2e7d4f; }}\n"
            "@media (prefers-color-scheme: dark) {{ svg {{ --paper: #131417; --ink: #ecebe6; --soft: "
            "#aaa9a4; --grid: "
            "#34363c; --a: #7db8f2; --b: #f39a7c; --c: #7fd3a1; }} }}\n"
            "text {{ font: 13px system-ui, -apple-system, \"Segoe UI\", Roboto, \"DejaVu Sans\", sans-serif; "
            "fill: "
            "var(--soft); }}\n"
            ".k {{ fill: var(--ink); }} path, line {{ fill: none; stroke: var(--ink); stroke-width: 1.8; "
            "stroke-linejoin: round; }}\n"
            ".a {{ stroke: var(--a); }} .b {{ stroke: var(--b); }} .c {{ stroke: var(--c); }} .s {{ stroke: "
            "var(--grid); "
            "stroke-width: 1; }}\n"
            ".d {{ stroke-dasharray: 6 5; }} .w {{ stroke-width: .8; }}\n"
            "text.a {{ fill: var(--a); stroke: none; }} text.b {{ fill: var(--b); stroke: none; }} text.c {{ "
            "fill: "
            "var(--c); stroke: none; }}\n"
            ".fa {{ fill: var(--a); fill-opacity: .16; stroke: none; }} .fb {{ fill: var(--b); stroke: "
            "var(--ink); "
            "stroke-width: 1; }}\n"
            ".m {{ text-anchor: middle; }} .e {{ text-anchor: end; }}\n"
            "</style>\n<rect width=\"{0}\" height=\"{1}\" fill=\"var(--paper)\"/>\n",
            width, height, title)) {}

  void path(const char* style, const std::vector<glm::dvec2>& points, bool is_closed = false,
            double opacity = 1) {
    text_ += fmt::format("<path class=\"{}\"{} d=\"", style,
                         opacity < 1 ? fmt::format(" fill-opacity=\"{:.3f}\"", opacity) : "");
    for (std::size_t i = 0; i < points.size(); ++i)
      text_ += fmt::format("{}{:.2f} {:.2f}", i == 0 ? "M" : "L", points[i].x, points[i].y);
    text_ += is_closed ? "Z\"/>\n" : "\"/>\n";
  }
  void line(const char* style, const glm::dvec2& a, const glm::dvec2& b) { path(style, {a, b}); }
  void words(const char* style, const glm::dvec2& at, const std::string& text) {
    text_ += fmt::format("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", style, at.x, at.y, text);
  }
  void write(const std::string& path) const { std::ofstream(path) << text_ << "</svg>\n"; }

 private:
  std::string text_;
};

/// Axes in a box of a drawing: x in [0,1], y in [y0, y1].
struct Axes {
  double left, top, width, height, y0, y1;
  glm::dvec2 operator()(double x, double y) const {
    return {left + width * x, top + height * (y1 - y) / (y1 - y0)};
  }
  void frame(Drawing& d, const std::string& x_name, const std::vector<double>& ticks) const {
    for (const double y : ticks) {
      d.line("s", (*this)(0, y), (*this)(1, y));
      d.words("e", (*this)(0, y) + glm::dvec2(-8, 4), fmt::format("{:g}", y));
    }
    d.words("e", {left + width, top + height + 34}, x_name);
  }
};

inline std::vector<glm::dvec2> curve(const Axes& axes, const std::function<double(double)>& f,
                                     double from = 0, double to = 1) {
  std::vector<glm::dvec2> points;
  constexpr int n = 120;
  for (int i = 0; i <= n; ++i) {
    const double x = from + (to - from) * i / n;
    points.push_back(axes(x, f(x)));
  }
  return points;
}

}  // namespace lambake
