#include <gtest/gtest.h>

#include <limits>
#include <regex>
#include <string>

#include "lambake/report/report.h"
#include "report/test_comparison.h"

namespace lambake {
namespace {

std::string headline(const Comparison& comparison) {
  const std::string page = report_page(comparison);
  const std::size_t begin = page.find("<h1>") + 4;
  return page.substr(begin, page.find("</h1>") - begin);
}

TEST(ReportPage, NothingIsFetched) {
  const std::string page = report_page(small_comparison());
  const std::regex reference("(src|href|url)(=\"|\\()([^\")]*)");
  std::size_t n_data = 0;
  for (std::sregex_iterator it(page.begin(), page.end(), reference), end; it != end; ++it) {
    const std::string target = (*it)[3];
    EXPECT_TRUE(target.starts_with("data:") || target.starts_with("#")) << target.substr(0, 80);
    n_data += target.starts_with("data:image/png;base64,");
  }
  EXPECT_GE(n_data, 3U);
  EXPECT_EQ(page.find("{{"), std::string::npos);
}

TEST(ReportPage, NamesOfTheUser_AreTextAndValidUtf8) {
  Comparison c = small_comparison();
  c.input = "<script>alert(1)</script>\"\xFF.ply";
  c.light_names = {"</table><b>", "\xC3"};
  c.command = "lambake compare '<x>' {{js}}";
  c.findings = {{"x", 1, "<i>"}};
  const std::string page = report_page(c);
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
  EXPECT_EQ(page.find("</table><b>"), std::string::npos);
  EXPECT_EQ(page.find("<i>"), std::string::npos);
  EXPECT_EQ(page.find('\xFF'), std::string::npos);
  EXPECT_NE(page.find("&lt;script&gt;alert(1)&lt;/script&gt;&quot;\uFFFD.ply"), std::string::npos);
  EXPECT_NE(page.find("&lt;x&gt;&#39; {{js}}"), std::string::npos);
}

TEST(ReportPage, Headline_SaysWhatTheNumbersSay) {
  Comparison c = small_comparison();
  EXPECT_NE(headline(c).find("difference is visible"), std::string::npos) << headline(c);
  EXPECT_NE(headline(c).find("20.7/255"), std::string::npos) << headline(c);
  c.main_loss = "light brighter than white";
  EXPECT_NE(headline(c).find("; most of it is light brighter than white."), std::string::npos) << headline(c);

  c.image_display.pixels_over_1_255 = 0;
  EXPECT_NE(headline(c).find("Seen from here"), std::string::npos) << headline(c);

  c.image_display.max = c.surface_display.max_sampled = 0.5 / 255;
  EXPECT_NE(headline(c).find("no place was found"), std::string::npos) << headline(c);

  c.max_bound_display = 0.75 / 255;
  EXPECT_NE(headline(c).find("0.75/255"), std::string::npos) << headline(c);
  EXPECT_NE(headline(c).find("certain"), std::string::npos) << headline(c);

  c.max_bound_display = std::numeric_limits<double>::infinity();
  EXPECT_EQ(headline(c).find("certain"), std::string::npos) << headline(c);

  c.verdict = "A & B";
  EXPECT_EQ(headline(c), "A &amp; B.");

  c.findings.push_back({"too_dark_to_see", 8, "vertices are all black"});
  EXPECT_NE(headline(c).find("Nothing is to be seen"), std::string::npos) << headline(c);
  c.surface_display.max_sampled = 0.5;  // Light that falls between the vertices is seen per pixel.
  EXPECT_EQ(headline(c).find("Nothing is to be seen"), std::string::npos) << headline(c);
}

TEST(ReportPage, EqualPictures_HaveNoZooms_AndSayEqual) {
  Comparison c = small_comparison();
  c.per_vertex = c.per_fragment;
  c.image_display.psnr_db = std::numeric_limits<double>::infinity();
  const std::string page = report_page(c);
  EXPECT_EQ(page.find("id=\"zoom-1\""), std::string::npos);
  EXPECT_NE(page.find("∞ (equal)"), std::string::npos);
  EXPECT_NE(report_page(small_comparison()).find("id=\"zoom-1\""), std::string::npos);
}

TEST(ReportPage, MethodsTried_AndStepsOfTheError_AreTold) {
  Comparison c = small_comparison();
  EXPECT_EQ(report_page(c).find("id=\"trials\""), std::string::npos);
  EXPECT_EQ(report_page(c).find("id=\"steps\""), std::string::npos);
  MethodTrial trial;
  trial.method = BakeMethod::least_squares;
  trial.n_vertices = 98765, trial.is_certified = true;
  c.trials = {trial};
  c.shares = {0.5, 0, 0.125};
  const std::string page = report_page(c);
  EXPECT_NE(page.find("least-squares"), std::string::npos);
  EXPECT_NE(page.find("98\u202F765"), std::string::npos);
  EXPECT_NE(page.find("within the tolerance"), std::string::npos);
  EXPECT_NE(page.find("width:25.00%"), std::string::npos);
}

TEST(ReportPage, RoundingBesideAOne_IsToldAsZero) {
  Comparison c = small_comparison();
  c.surface_display.worst[0].barycentrics = {1.1e-16, 0.5, 0.5};
  EXPECT_NE(report_page(c).find(">0, 0.5, 0.5<"), std::string::npos);
}

TEST(ReportPage, SameComparison_SameBytes) {
  EXPECT_EQ(report_page(small_comparison()), report_page(small_comparison()));
}

}  // namespace
}  // namespace lambake
