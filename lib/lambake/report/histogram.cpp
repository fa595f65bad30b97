#include "lambake/report/charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "lambake/report/text.h"

namespace lambake {

std::string histogram_svg(const std::array<std::size_t, 256>& bins) {
  constexpr double width = 560, height = 300, left = 78, right = 8, top = 26, bottom = 46;
  std::size_t n_shown = 9;  // At least so many, so that a perfect result does not look like a wall.
  for (std::size_t i = 0; i < bins.size(); ++i)
    if (bins[i] > 0) n_shown = std::max(n_shown, i + 1);
  const std::size_t largest = std::max<std::size_t>(10, *std::max_element(bins.begin(), bins.end()));
  const double decades = std::ceil(std::log10(static_cast<double>(largest)));
  const double bar = (width - left - right) / static_cast<double>(n_shown);
  // One pixel stands half a decade high: the logarithm of 1 is 0, and it must be seen.
  const auto y_of = [&](double count) {
    return height - bottom - (std::log10(count) + 0.5) / (decades + 0.5) * (height - top - bottom);
  };

  std::string svg = fmt::format(
      "<svg class=\"chart\" viewBox=\"0 0 {} {}\" role=\"img\" aria-labelledby=\"histogram-title\">\n"
      "<title id=\"histogram-title\">Histogram: number of pixels (logarithmic) over their difference in "
      "steps of 1/255</title>\n<text x=\"0\" y=\"12\">pixels</text>\n",
      width, height);
  auto out = std::back_inserter(svg);
  const int stride = decades > 5 ? 2 : 1;
  for (int d = 0; d <= static_cast<int>(decades); d += stride) {
    const double y = y_of(std::pow(10.0, d));
    fmt::format_to(out,
                   "<path class=\"axis\" d=\"M{} {:.1f}H{}\"/><text x=\"{}\" y=\"{:.1f}\" "
                   "text-anchor=\"end\">{}</text>\n",
                   left, y, width - right, left - 6, y + 4,
                   grouped(static_cast<std::size_t>(std::pow(10.0, d))));
  }
  for (std::size_t i = 0; i < n_shown; ++i) {
    if (bins[i] == 0) continue;
    const double y = y_of(static_cast<double>(bins[i]));
    fmt::format_to(out, "<rect class=\"{}\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"/>\n",
                   i <= 1 ? "bar" : "bar over", left + bar * static_cast<double>(i), y,
                   std::max(0.5, bar - (bar > 4 ? 1 : 0)), height - bottom - y);
  }
  fmt::format_to(out, "<path class=\"axis\" d=\"M{} {}H{}\"/>\n", left, height - bottom, width - right);
  std::size_t step = 1;
  while (n_shown / step > 10) step *= 2;
  for (std::size_t i = 0; i < n_shown; i += step)
    fmt::format_to(out, "<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                   left + bar * (static_cast<double>(i) + 0.5), height - bottom + 17, i);
  fmt::format_to(
      out,
      "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">difference on screen, steps of 1/255</text>\n</svg>\n",
      width - right, height - 6);
  return svg;
}

}  // namespace lambake
