#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace lambake {

/// One measurement in a log–log chart.
struct ChartPoint {
  double x = 0, y = 0;           ///< x > 0; y of 0 lies in a strip of its own below the axis.
  double x_low = 0, x_high = 0;  ///< Spread of x, drawn as a bar; 0: none.
  std::string label{};           ///< Beside the point; empty: none.
  bool is_emphasised = false;    ///< Ringed.
};

/// Points of one kind: one colour, and one shape of mark for readers without colour.
struct ChartSeries {
  std::string name;  ///< In the legend.
  std::vector<ChartPoint> points;
  bool is_line = false;               ///< Joined in their order.
  bool is_compared = true;            ///< Takes part in the Pareto front.
  std::optional<std::size_t> kind{};  ///< Number of its colour and shape; none: that of its place.
};

/// A dashed line between two points, with words at its end: a slope to compare with.
struct ChartGuide {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  std::string label;
};

struct ChartAxis {
  std::string label;                          ///< Quantity and unit.
  std::function<std::string(double)> format;  ///< Of the numbers at the ticks.
};

/// A log–log chart.
struct Chart {
  std::string id;     ///< Unique in a page; letters, digits, hyphens.
  std::string title;  ///< Also what a screen reader says.
  ChartAxis x, y;
  std::vector<ChartSeries> series{};
  std::vector<ChartGuide> guides{};
  /// Draws the Pareto front: points that no other beats in both x and y, small is good.
  bool has_front = false;
};

/// SVG of `width`×`height` units; letters are 13 units high. Every text keeps clear of the marks and of the
/// other texts where there is room.
/// @param is_standalone  a file: brings its style, for light and dark; otherwise part of a page with the
///                       page's style sheet.
std::string chart_svg(const Chart& chart, double width, double height, bool is_standalone);

/// The same twice, for wide and for narrow windows; the page's style sheet shows the one that fits.
std::string responsive_chart_svg(const Chart& chart);

/// Indices of the points on the Pareto front, by increasing x: each has smaller y than all with smaller x.
std::vector<std::size_t> pareto_front(const std::vector<ChartPoint>& points);

/// Inline SVG of a histogram of `bins` counts, bin i for differences of i/255: bars of the logarithm, so that
/// a single pixel still shows; empty bins beyond the last used one are left out. Colours come from the style
/// sheet of the page.
std::string histogram_svg(const std::array<std::size_t, 256>& bins);

}  // namespace lambake
