#include "lambake/report/charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <string_view>
#include <utility>

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
  struct Mark {
    double x, y;  ///< Where the outline begins, from the middle.
    const char* outline;
  };
  constexpr Mark marks[n_kinds] = {{-5, 0, "a5 5 0 1 0 10 0a5 5 0 1 0 -10 0z"},
                                   {-4.5, -4.5, "h9v9h-9z"},
                                   {0, -6, "l6 10h-12z"},
                                   {0, -6, "l6 6l-6 6l-6 -6z"},
                                   {0, 6, "l-6 -10h12z"},
                                   {-2, -6, "h4v4h4v4h-4v4h-4v-4h-4v-4h4z"},
                                   {0, -6, "l6 4.4l-2.3 7h-7.4l-2.3 -7z"},
                                   {-6, -2.5, "h12v5h-12z"}};
  const Mark& mark = marks[kind % n_kinds];
  return fmt::format("M{:.1f} {:.1f}{}", x + mark.x, y + mark.y, mark.outline);
}

bool has_spread(const ChartPoint& p) {
  return p.x_low > 0 && p.x_high > 0;
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

/// A chart while it is drawn, from the back to the front.
class ChartDrawing {
 public:
  ChartDrawing(const Chart& chart, double width, double height)
      : chart_(chart), width_(width), height_(height) {
    std::vector<ChartPoint> compared;  // As good as nothing where the series takes no part.
    for (const ChartSeries& series : chart.series)
      for (const ChartPoint& p : series.points) {
        points_.push_back(p);
        compared.push_back({p.x, series.is_compared ? p.y : std::numeric_limits<double>::infinity()});
      }
    if (chart.has_front) front_ = pareto_front(compared);
  }

  std::string svg(bool is_standalone) {
    begin(is_standalone);
    place_plot(draw_legend());
    draw_axes();
    draw_guides();
    draw_front();
    draw_series();
    draw_labels();
    return svg_ + "</svg>\n";
  }

 private:
  template <typename... Values>
  void add(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(svg_), format, std::forward<Values>(values)...);
  }
  double y_at(double y) const { return y > 0 ? y_scale_(y) : plot_.y1 - zero_strip_ / 2 + 4; }
  bool is_on_front(std::size_t point) const {
    return std::find(front_.begin(), front_.end(), point) != front_.end();
  }
  Placed place(const Box& mark, const std::string& text) {
    const Placed at = place_label(mark, text, plot_, taken_);
    taken_.push_back(at.box);
    return at;
  }
  void draw_text(const char* css_class, const Placed& at, const std::string& text) {
    add("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\"{}>{}</text>\n", css_class, at.anchor_x, at.box.y1 - 2.5,
        at.anchor, escape_html(text));
  }

  void begin(bool is_standalone) {
    const std::string size =
        is_standalone ? fmt::format(" width=\"{}\" height=\"{}\"", width_, height_) : std::string();
    add("<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"chart\" viewBox=\"0 0 {0} {1}\"{2} role=\"img\" "
        "aria-labelledby=\"{3}-title\">\n<title id=\"{3}-title\">{4}</title>\n",
        width_, height_, size, chart_.id, escape_html(chart_.title));
    if (is_standalone)
      add("<style>\n{}</style>\n<rect class=\"paper\" width=\"{}\" height=\"{}\"/>\n", page_assets::chart_css,
          width_, height_);
  }

  /// As many lines as it needs; returns where the last one stands.
  double draw_legend() {
    double x = 12, y = 18;
    for (std::size_t i = 0; i < chart_.series.size(); ++i) {
      const std::string& name = chart_.series[i].name;
      const std::size_t kind = chart_.series[i].kind.value_or(i);
      const double w = 20 + width_of(name);
      if (x + w > width_ && x > 12) x = 12, y += 20;
      add("<path class=\"mark kind-{}\" d=\"{}\"/><text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
          kind % n_kinds, mark_path(kind, x + 6, y - 4.5), x + 17, y, escape_html(name));
      x += w + 14;
    }
    return y;
  }

  void place_plot(double legend_bottom) {
    std::vector<double> xs, ys;
    for (const ChartPoint& p : points_) {
      xs.insert(xs.end(), {p.x, p.x_low, p.x_high});
      ys.push_back(p.y);
      if (!(p.y > 0)) zero_strip_ = 30;
    }
    for (const ChartGuide& g : chart_.guides) {
      xs.insert(xs.end(), {g.x0, g.x1});
      ys.insert(ys.end(), {g.y0, g.y1});
    }
    plot_ = {64, legend_bottom + 42, width_ - 30, height_ - 50};
    x_scale_ = scale_over(xs, plot_.x0, plot_.x1);
    y_scale_ = scale_over(ys, plot_.y1 - zero_strip_, plot_.y0);
    for (const ChartPoint& p : points_) {
      const double x = x_scale_(p.x), y = y_at(p.y), r = p.is_emphasised ? 12 : mark_radius + 2;
      marks_.push_back({std::min(x - r, has_spread(p) ? x_scale_(p.x_low) : x), y - r,
                        std::max(x + r, has_spread(p) ? x_scale_(p.x_high) : x), y + r});
    }
    taken_ = marks_;
  }

  void draw_axes() {
    add("<text class=\"axis-name\" x=\"4\" y=\"{:.1f}\">{}</text>\n", plot_.y0 - 14,
        escape_html(chart_.y.label));
    add("<text class=\"axis-name\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n", plot_.x1,
        height_ - 8, escape_html(chart_.x.label));
    const auto draw_row = [&](const char* css_class, double y, double text_y, const std::string& text) {
      add("<path class=\"{}\" d=\"M{} {:.1f}H{}\"/><text x=\"{}\" y=\"{:.1f}\" "
          "text-anchor=\"end\">{}</text>\n",
          css_class, plot_.x0, y, plot_.x1, plot_.x0 - 7, text_y, text);
    };
    for (const double tick : ticks_of(y_scale_, 9))
      draw_row("axis", y_scale_(tick), y_scale_(tick) + 4.5, escape_html(chart_.y.format(tick)));
    if (zero_strip_ > 0) draw_row("axis zero", y_at(0), y_at(0) + 4.5, "0");
    for (const double tick : ticks_of(x_scale_, static_cast<std::size_t>((plot_.x1 - plot_.x0) / 62)))
      add("<path class=\"axis\" d=\"M{x:.1f} {}V{}\"/><text x=\"{x:.1f}\" y=\"{}\" "
          "text-anchor=\"middle\">{}</text>\n",
          plot_.y0, plot_.y1, plot_.y1 + 18, escape_html(chart_.x.format(tick)),
          fmt::arg("x", x_scale_(tick)));
  }

  void draw_guides() {
    for (const ChartGuide& g : chart_.guides) {
      const double x0 = x_scale_(g.x0), y0 = y_scale_(g.y0), x1 = x_scale_(g.x1), y1 = y_scale_(g.y1);
      add("<path class=\"guide\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n", x0, y0, x1, y1);
      draw_text("guide-name", place({x1, y1, x1, y1}, g.label), g.label);
    }
  }

  void draw_front() {
    if (front_.size() < 2) return;
    std::string path;
    for (const std::size_t i : front_)
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', x_scale_(points_[i].x),
                          y_at(points_[i].y));
    add("<path class=\"front\" d=\"{}\"/>\n", path);
  }

  void draw_series() {
    std::size_t index = 0;
    for (std::size_t i = 0; i < chart_.series.size(); ++i) {
      const ChartSeries& series = chart_.series[i];
      const std::size_t kind = series.kind.value_or(i);
      std::string path, marks;
      for (const ChartPoint& p : series.points) {
        const double x = x_scale_(p.x), y = y_at(p.y);
        path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', x, y);
        if (has_spread(p))
          marks += fmt::format("<path class=\"spread kind-{}\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>\n",
                               kind % n_kinds, x_scale_(p.x_low), y, x_scale_(p.x_high));
        if (p.is_emphasised)
          marks += fmt::format("<circle class=\"ring\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"11\"/>\n", x, y);
        const bool is_hollow = chart_.has_front && !is_on_front(index);
        marks += fmt::format("<path class=\"mark kind-{}{}\" d=\"{}\"/>\n", kind % n_kinds,
                             is_hollow ? " hollow" : "", mark_path(kind, x, y));
        ++index;
      }
      if (series.is_line && series.points.size() > 1)
        add("<path class=\"line kind-{}\" d=\"{}\"/>\n", kind % n_kinds, path);
      svg_ += marks;
    }
  }

  void draw_labels() {
    // Those of the front first: they get the best places.
    std::vector<std::size_t> order = front_;
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (!is_on_front(i)) order.push_back(i);
    for (const std::size_t i : order) {
      const ChartPoint& p = points_[i];
      if (p.label.empty()) continue;
      const Placed at = place(marks_[i], p.label);
      const double x = x_scale_(p.x), y = y_at(p.y);
      if (at.is_far)
        add("<path class=\"leader\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n", x, y,
            std::clamp(x, at.box.x0, at.box.x1), std::clamp(y, at.box.y0, at.box.y1));
      draw_text("label", at, p.label);
    }
  }

  const Chart& chart_;
  double width_, height_;
  std::vector<ChartPoint> points_;  ///< Of all series, in their order.
  std::vector<std::size_t> front_;  ///< Into `points_`, by increasing x.
  Box plot_{};                      ///< Between the axes.
  double zero_strip_ = 0;           ///< Height of the strip for points at 0, at the plot's bottom.
  Scale x_scale_, y_scale_;
  std::vector<Box> marks_;  ///< One per point, with its spread.
  std::vector<Box> taken_;  ///< Where no text may stand.
  std::string svg_;
};

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
  return ChartDrawing(chart, width, height).svg(is_standalone);
}

std::string responsive_chart_svg(const Chart& chart) {
  Chart narrow = chart;
  narrow.id += "-narrow";
  return "<div class=\"wide\">" + chart_svg(chart, 1080, 640, false) + "</div>\n<div class=\"narrow\">" +
         chart_svg(narrow, 380, 620, false) + "</div>\n";
}

}  // namespace lambake
