#include <gtest/gtest.h>

#include <regex>
#include <string>

#include "lambake/report/charts.h"

namespace lambake {
namespace {

std::string plain(double value) {
  return std::to_string(value);
}

Chart chart_of(std::vector<ChartPoint> points) {
  Chart chart;
  chart.id = "test";
  chart.title = "A <title>";
  chart.x = {"time", plain};
  chart.y = {"error", plain};
  chart.series.push_back({"series", std::move(points)});
  return chart;
}

std::size_t count(const std::string& text, const std::string& pattern) {
  std::size_t n = 0;
  for (std::size_t at = text.find(pattern); at != std::string::npos; at = text.find(pattern, at + 1)) ++n;
  return n;
}

TEST(ParetoFront, PointsThatNoOtherBeats_InOrderOfX) {
  const std::vector<ChartPoint> points = {{3, 1}, {1, 5}, {2, 2}, {2.5, 4}, {4, 1}, {2, 3}};
  EXPECT_EQ(pareto_front(points), (std::vector<std::size_t>{1, 2, 0}));
  EXPECT_TRUE(pareto_front({}).empty());
}

TEST(ChartSvg, EveryPoint_HasAMarkAndItsLabel) {
  const std::string svg =
      chart_svg(chart_of({{1, 1, 0, 0, "one & only"}, {10, 0.1, 8, 12, "two"}, {100, 0, 0, 0, "exact"}}), 800,
                500, true);
  EXPECT_EQ(count(svg, "<path class=\"mark"), 4U);  // and one in the legend
  EXPECT_EQ(count(svg, "class=\"label\""), 3U);
  EXPECT_EQ(count(svg, "class=\"spread"), 1U);
  EXPECT_NE(svg.find(">one &amp; only</text>"), std::string::npos);
  EXPECT_NE(svg.find("A &lt;title&gt;"), std::string::npos);
  EXPECT_NE(svg.find("axis zero"), std::string::npos);
}

TEST(ChartSvg, TwentyPointsOnOneSpot_LabelsKeepClearOfEachOther) {
  std::vector<ChartPoint> points(20, {1, 1, 0, 0, "a label"});
  const std::string svg = chart_svg(chart_of(points), 900, 600, false);
  const std::regex label("class=\"label\" x=\"([0-9.]+)\" y=\"([0-9.]+)\"( text-anchor=\"(end|middle)\")?");
  std::vector<std::array<double, 2>> left_base;
  const double width = 7 * 6.0;  // letters narrower than the chart reckons with
  for (std::sregex_iterator it(svg.begin(), svg.end(), label), end; it != end; ++it) {
    const double x = std::stod((*it)[1]), y = std::stod((*it)[2]);
    left_base.push_back({(*it)[4] == "end" ? x - width : (*it)[4] == "middle" ? x - width / 2 : x, y});
  }
  ASSERT_EQ(left_base.size(), points.size());
  for (std::size_t i = 0; i < left_base.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_TRUE(std::abs(left_base[i][0] - left_base[j][0]) >= width ||
                  std::abs(left_base[i][1] - left_base[j][1]) >= 12)
          << i << " and " << j;
}

TEST(ChartSvg, SeriesThatIsNotCompared_StaysOffTheFront) {
  Chart chart = chart_of({{1, 10}, {2, 5}});
  chart.has_front = true;
  chart.series.push_back({"per pixel", {{0.5, 0}}, false, false});
  const std::string svg = chart_svg(chart, 800, 500, false);
  const std::regex front("class=\"front\" d=\"M[0-9. ]+L[0-9. ]+\"");
  EXPECT_TRUE(std::regex_search(svg, front)) << svg;
}

TEST(ChartSvg, NoPoints_StillHasAxes) {
  EXPECT_GT(count(chart_svg(chart_of({}), 800, 500, false), "class=\"axis\""), 3U);
}

TEST(HistogramSvg, EmptyBins_HaveNoBars_OnePixelHas) {
  std::array<std::size_t, 256> bins{};
  EXPECT_EQ(count(histogram_svg(bins), "<rect"), 0U);
  bins[0] = 100000, bins[200] = 1;
  const std::string svg = histogram_svg(bins);
  EXPECT_EQ(count(svg, "<rect"), 2U);
  EXPECT_EQ(count(svg, "height=\"0.00\""), 0U);
}

}  // namespace
}  // namespace lambake
