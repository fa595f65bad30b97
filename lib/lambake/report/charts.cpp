#include "lambake/report/charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <iterator>
#include <limits>
#include <numeric>
#include <string_view>

#include "lambake/report/page_assets.h"
#include "lambake/report/text.h"

namespace lambake {
namespace {

constexpr double letter_height = 13;  ///< Units.
constexpr double mark_radius = 5;
constexpr std::size_t n_kinds = 8;  ///< Colours and shapes of marks.

struct Box {
  double x0, y0, x1, y1;
  double overlap(const Box& o) const {
    return std::max(0.0, std::min(x1, o.x1) - std::max(x0, o.x0)) *
           std::max(0.0, std::min(y1, o.y1) - std::max(y0, o.y0));
  }
};

/// Of letters of that height in a wide sans-serif face (DejaVu Sans), in units.
double width_of(std::string_view text) {
  double width = 0;
  for (const char c : text) {
    if ((c & 0xC0) == 0x80) continue;  // Inside of a letter of several bytes.
    if (c < 0)
      width += 9;  // ×, µ and the like
    else if (c >= '0' && c <= '9')
      width += 8.3;
    else if (std::string_view("iljtfr ,.:/'|").find(c) != std::string_view::npos)
      width += 4.6;
    else if (c >= 'A' && c <= 'Z')
      width += 9.2;
    else
      width += c == 'm' || c == 'w' ? 11.7 : 8;
  }
  return width;
}

/// The range of a logarithmic axis.
struct Scale {
  double low = 1, high = 10;  ///< Values at the ends.
  double from = 0, to = 1;    ///< Units at the ends.
  double operator()(double value) const {
    return from + (to - from) * std::log(value / low) / std::log(high / low);
  }
};

/// The nearest of 1, 2, 5 × 10^n below or above.
double round_to_125(double value, bool up) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  double best = up ? 10 * decade : decade;
  for (const double f : {1.0, 2.0, 5.0}) {
    if (up && f * decade >= value * (1 - 1e-9)) return f * decade;
    if (!up && f * decade <= value * (1 + 1e-9)) best = f * decade;
  }
  return best;
}

Scale scale_over(const std::vector<double>& values, double from, double to) {
  Scale scale{std::numeric_limits<double>::infinity(), 0, from, to};
  for (const double v : values)
    if (v > 0 && std::isfinite(v)) scale.low = std::min(scale.low, v), scale.high = std::max(scale.high, v);
  if (!(scale.high > 0)) return {0.1, 10, from, to};
  scale.low = round_to_125(scale.low / 1.3, false);
  scale.high = round_to_125(scale.high * 1.3, true);
  return scale;
}

/// Ticks at each power of ten; with few decades at 2 and 5 of each, too.
std::vector<double> ticks_of(const Scale& scale, std::size_t most) {
  const auto between = [&](std::initializer_list<double> factors, int stride) {
    std::vector<double> ticks;
    const int first = static_cast<int>(std::floor(std::log10(scale.low) + 1e-9));
    for (int d = first; d <= static_cast<int>(std::ceil(std::log10(scale.high))); d += stride)
      for (const double f : factors) {
        const double tick = f * std::pow(10.0, d);
        if (tick >= scale.low * (1 - 1e-9) && tick <= scale.high * (1 + 1e-9)) ticks.push_back(tick);
      }
    return ticks;
  };
  std::vector<double> ticks = between({1, 2, 5}, 1);
  if (ticks.size() > most) ticks = between({1}, 1);
  for (int stride = 2; ticks.size() > most; ++stride) ticks = between({1}, stride);
  return ticks;
}

std::string mark_path(std::size_t kind, double x, double y) {
  const double r = mark_radius;
  switch (kind % n_kinds) {
    case 0:
      return fmt::format("M{:.1f} {:.1f}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0z", x - r, y,
                         fmt::arg("r", r), fmt::arg("d", 2 * r));
    case 1:
      return fmt::format("M{:.1f} {:.1f}h9v9h-9z", x - 4.5, y - 4.5);
    case 2:
      return fmt::format("M{:.1f} {:.1f}l6 10h-12z", x, y - 6);
    case 3:
      return fmt::format("M{:.1f} {:.1f}l6 6l-6 6l-6 -6z", x, y - 6);
    case 4:
      return fmt::format("M{:.1f} {:.1f}l-6 -10h12z", x, y + 6);
    case 5:
      return fmt::format("M{:.1f} {:.1f}h4v4h4v4h-4v4h-4v-4h-4v-4h4z", x - 2, y - 6);
    case 6:
      return fmt::format("M{:.1f} {:.1f}l6 4.4l-2.3 7h-7.4l-2.3 -7z", x, y - 6);
    default:
      return fmt::format("M{:.1f} {:.1f}h12v5h-12z", x - 6, y - 2.5);
  }
}

/// Where a label stands, and whether a line must lead to its point. The side towards the point is exact, as
/// the width of letters is a guess.
struct Placed {
  Box box;
  bool is_far = false;
  double anchor_x = 0;
  const char* anchor = "";
};

/// The nearest free place around `mark` for a text; the one with least overlap if none is free.
Placed place_label(const Box& mark, std::string_view text, const Box& plot, const std::vector<Box>& taken) {
  const double w = width_of(text), h = letter_height;
  Placed best{{0, 0, 0, 0}};
  double least = std::numeric_limits<double>::infinity();
  const double x = (mark.x0 + mark.x1) / 2, y = (mark.y0 + mark.y1) / 2;
  for (const double r : {2.0, 12.0, 26.0, 42.0, 60.0, 82.0, 107.0})
    for (const auto& [dx, dy] : {std::pair{1.0, 0.0},
                                 {-1.0, 0.0},
                                 {0.0, -1.0},
                                 {0.0, 1.0},
                                 {0.8, -0.7},
                                 {0.8, 0.7},
                                 {-0.8, -0.7},
                                 {-0.8, 0.7}}) {
      const double cx = dx > 0 ? mark.x1 + dx * r + w / 2 : dx < 0 ? mark.x0 + dx * r - w / 2 : x;
      const double cy = dy > 0 ? mark.y1 + dy * r + h / 2 : dy < 0 ? mark.y0 + dy * r - h / 2 : y;
      const Box box{cx - w / 2, cy - h / 2, cx + w / 2, cy + h / 2};
      double cost = 0;
      for (const Box& other : taken) cost += box.overlap(other);
      const double inside = box.overlap(plot);
      cost += 4 * (w * h - inside);
      if (cost >= least - 1e-6) continue;
      least = cost;
      if (dx > 0)
        best = {box, r > 5, box.x0, ""};
      else if (dx < 0)
        best = {box, r > 5, box.x1, " text-anchor=\"end\""};
      else
        best = {box, r > 5, cx, " text-anchor=\"middle\""};
      if (least <= 1e-6) return best;
    }
  return best;
}

}  // namespace

std::vector<std::size_t> pareto_front(const std::vector<ChartPoint>& points) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair{points[a].x, points[a].y} < std::pair{points[b].x, points[b].y};
  });
  std::vector<std::size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order)
    if (points[i].y < least) least = points[i].y, front.push_back(i);
  return front;
}

std::string chart_svg(const Chart& chart, double width, double height, bool is_standalone) {
  std::vector<ChartPoint> all, compared;
  std::vector<std::size_t> compared_indices;  // Into `all`.
  std::vector<double> xs, ys;
  bool has_zero = false;
  for (const ChartSeries& series : chart.series)
    for (const ChartPoint& p : series.points) {
      if (series.is_compared) compared.push_back(p), compared_indices.push_back(all.size());
      all.push_back(p);
      xs.insert(xs.end(), {p.x, p.x_low, p.x_high});
      ys.push_back(p.y);
      has_zero |= !(p.y > 0);
    }
  for (const ChartGuide& g : chart.guides) {
    xs.insert(xs.end(), {g.x0, g.x1});
    ys.insert(ys.end(), {g.y0, g.y1});
  }
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"chart\" viewBox=\"0 0 {0} {1}\"{2} role=\"img\" "
      "aria-labelledby=\"{3}-title\">\n<title id=\"{3}-title\">{4}</title>\n",
      width, height,
      is_standalone ? fmt::format(" width=\"{}\" height=\"{}\"", width, height) : std::string(), chart.id,
      escape_html(chart.title));
  auto out = std::back_inserter(svg);
  if (is_standalone)
    fmt::format_to(out, "<style>\n{}</style>\n<rect class=\"paper\" width=\"{}\" height=\"{}\"/>\n",
                   page_assets::chart_css, width, height);

  // The legend, as many lines as it needs.
  double legend_x = 12, legend_y = 18;
  for (std::size_t kind = 0; kind < chart.series.size(); ++kind) {
    const std::string& name = chart.series[kind].name;
    const double w = 20 + width_of(name);
    if (legend_x + w > width && legend_x > 12) legend_x = 12, legend_y += 20;
    fmt::format_to(out, "<path class=\"mark kind-{}\" d=\"{}\"/><text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
                   kind % n_kinds, mark_path(kind, legend_x + 6, legend_y - 4.5), legend_x + 17, legend_y,
                   escape_html(name));
    legend_x += w + 14;
  }

  const double strip = has_zero ? 30 : 0;
  const Box plot{64, legend_y + 42, width - 30, height - 50};
  const Scale x_scale = scale_over(xs, plot.x0, plot.x1);
  const Scale y_scale = scale_over(ys, plot.y1 - strip, plot.y0);
  const auto y_at = [&](double y) { return y > 0 ? y_scale(y) : plot.y1 - strip / 2 + 4; };

  // Axes.
  fmt::format_to(out, "<text class=\"axis-name\" x=\"4\" y=\"{:.1f}\">{}</text>\n", plot.y0 - 14,
                 escape_html(chart.y.label));
  fmt::format_to(out, "<text class=\"axis-name\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
                 plot.x1, height - 8, escape_html(chart.x.label));
  const auto n_x = static_cast<std::size_t>((plot.x1 - plot.x0) / 62), n_y = std::size_t{9};
  for (const double tick : ticks_of(y_scale, n_y))
    fmt::format_to(out,
                   "<path class=\"axis\" d=\"M{} {y:.1f}H{}\"/><text x=\"{}\" y=\"{:.1f}\" "
                   "text-anchor=\"end\">{}</text>\n",
                   plot.x0, plot.x1, plot.x0 - 7, y_scale(tick) + 4.5, escape_html(chart.y.format(tick)),
                   fmt::arg("y", y_scale(tick)));
  if (has_zero)
    fmt::format_to(out,
                   "<path class=\"axis zero\" d=\"M{} {y:.1f}H{}\"/><text x=\"{}\" y=\"{:.1f}\" "
                   "text-anchor=\"end\">0</text>\n",
                   plot.x0, plot.x1, plot.x0 - 7, y_at(0) + 4.5, fmt::arg("y", y_at(0)));
  for (const double tick : ticks_of(x_scale, n_x))
    fmt::format_to(out,
                   "<path class=\"axis\" d=\"M{x:.1f} {}V{}\"/><text x=\"{x:.1f}\" y=\"{}\" "
                   "text-anchor=\"middle\">{}</text>\n",
                   plot.y0, plot.y1, plot.y1 + 18, escape_html(chart.x.format(tick)),
                   fmt::arg("x", x_scale(tick)));

  // Lines below marks below labels.
  std::vector<Box> taken;
  for (const ChartPoint& p : all) {
    const double x = x_scale(p.x), y = y_at(p.y), r = p.is_emphasised ? 12 : mark_radius + 2;
    const bool has_spread = p.x_low > 0 && p.x_high > 0;
    taken.push_back({std::min(x - r, has_spread ? x_scale(p.x_low) : x), y - r,
                     std::max(x + r, has_spread ? x_scale(p.x_high) : x), y + r});
  }
  const std::vector<Box> marks_taken = taken;
  for (const ChartGuide& g : chart.guides) {
    const double x0 = x_scale(g.x0), y0 = y_scale(g.y0), x1 = x_scale(g.x1), y1 = y_scale(g.y1);
    fmt::format_to(out, "<path class=\"guide\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n", x0, y0, x1, y1);
    const Placed at = place_label({x1, y1, x1, y1}, g.label, plot, taken);
    taken.push_back(at.box);
    fmt::format_to(out, "<text class=\"guide-name\" x=\"{:.1f}\" y=\"{:.1f}\"{}>{}</text>\n", at.anchor_x,
                   at.box.y1 - 2.5, at.anchor, escape_html(g.label));
  }
  std::vector<std::size_t> front;
  if (chart.has_front)
    for (const std::size_t i : pareto_front(compared)) front.push_back(compared_indices[i]);
  if (front.size() > 1) {
    std::string path;
    for (const std::size_t i : front)
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', x_scale(all[i].x), y_at(all[i].y));
    fmt::format_to(out, "<path class=\"front\" d=\"{}\"/>\n", path);
  }
  std::size_t index = 0;
  for (std::size_t kind = 0; kind < chart.series.size(); ++kind) {
    const ChartSeries& series = chart.series[kind];
    std::string path, marks;
    for (const ChartPoint& p : series.points) {
      const double x = x_scale(p.x), y = y_at(p.y);
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', x, y);
      if (p.x_low > 0 && p.x_high > 0)
        marks += fmt::format("<path class=\"spread kind-{}\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>\n", kind % n_kinds,
                             x_scale(p.x_low), y, x_scale(p.x_high));
      if (p.is_emphasised)
        marks += fmt::format("<circle class=\"ring\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"11\"/>\n", x, y);
      const bool is_hollow = chart.has_front && std::find(front.begin(), front.end(), index) == front.end();
      marks += fmt::format("<path class=\"mark kind-{}{}\" d=\"{}\"/>\n", kind % n_kinds,
                           is_hollow ? " hollow" : "", mark_path(kind, x, y));
      ++index;
    }
    if (series.is_line && series.points.size() > 1)
      fmt::format_to(out, "<path class=\"line kind-{}\" d=\"{}\"/>\n", kind % n_kinds, path);
    svg += marks;
  }
  // Labels of the front first: they get the best places.
  std::vector<std::size_t> order = front;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (std::find(front.begin(), front.end(), i) == front.end()) order.push_back(i);
  for (const std::size_t i : order) {
    const ChartPoint& p = all[i];
    if (p.label.empty()) continue;
    const Placed at = place_label(marks_taken[i], p.label, plot, taken);
    taken.push_back(at.box);
    const double x = x_scale(p.x), y = y_at(p.y);
    if (at.is_far)
      fmt::format_to(out, "<path class=\"leader\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n", x, y,
                     std::clamp(x, at.box.x0, at.box.x1), std::clamp(y, at.box.y0, at.box.y1));
    fmt::format_to(out, "<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\"{}>{}</text>\n", at.anchor_x,
                   at.box.y1 - 2.5, at.anchor, escape_html(p.label));
  }
  return svg + "</svg>\n";
}

std::string responsive_chart_svg(const Chart& chart) {
  Chart narrow = chart;
  narrow.id += "-narrow";
  return "<div class=\"wide\">" + chart_svg(chart, 1080, 640, false) + "</div>\n<div class=\"narrow\">" +
         chart_svg(narrow, 380, 620, false) + "</div>\n";
}

}  // namespace lambake
