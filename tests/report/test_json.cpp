#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "lambake/report/report.h"
#include "report/test_comparison.h"

namespace lambake {
namespace {

using nlohmann::json;

TEST(ReportJson, Numbers_AreReadBackTheSame) {
  Comparison c = small_comparison();
  c.image_linear.rmse = 0.1 + 0.2;
  c.surface_display.max_sampled = std::nextafter(1.0 / 255, 1.0);
  const json report = json::parse(report_json(c));
  EXPECT_EQ(report["image"]["linear"]["rmse"].get<double>(), c.image_linear.rmse);
  EXPECT_EQ(report["surface"]["display"]["max_sampled"].get<double>(), c.surface_display.max_sampled);
  EXPECT_EQ(report["image"]["display"]["pixels"], c.image_display.pixels);
  EXPECT_EQ(report["image"]["display"]["histogram"].size(), 256U);
  EXPECT_EQ(report["image"]["display"]["histogram"][12], 1100);
  EXPECT_FALSE(report["image"]["linear"].contains("histogram"));
}

TEST(ReportJson, ShortNumbers_ArePrintedShort) {
  Comparison c = small_comparison();
  c.image_linear.rmse = 0.1;
  EXPECT_NE(report_json(c).find("\"rmse\": 0.1,"), std::string::npos);
}

TEST(ReportJson, EqualPictures_HaveNoPsnr) {
  Comparison c = small_comparison();
  c.image_display.psnr_db = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(json::parse(report_json(c))["image"]["display"]["psnr_db"].is_null());
}

TEST(ReportJson, Bound_IsThereOnlyWhenComputed_AndNullWhenUnbounded) {
  Comparison c = small_comparison();
  EXPECT_FALSE(json::parse(report_json(c))["surface"]["display"].contains("max_bound"));
  c.max_bound_display = 0.5;
  c.max_bound_linear = std::numeric_limits<double>::infinity();
  const json surface = json::parse(report_json(c))["surface"];
  EXPECT_EQ(surface["display"]["max_bound"], 0.5);
  EXPECT_TRUE(surface["linear"]["max_bound"].is_null());
}

TEST(ReportJson, WorstPlaces_FirstIsMaxAt) {
  Comparison c = small_comparison();
  const json report = json::parse(report_json(c));
  EXPECT_EQ(report["max_at"], report["worst"][0]);
  EXPECT_EQ(report["max_at"]["face"], 3);
  EXPECT_EQ(report["max_at"]["barycentrics"], json({0.25, 0.5, 0.25}));
  c.surface_display.worst.clear();
  EXPECT_TRUE(json::parse(report_json(c))["max_at"].is_null());
}

TEST(ReportJson, StagesOfOneName_AddUp) {
  const json seconds = json::parse(report_json(small_comparison()))["seconds"];
  EXPECT_EQ(seconds, json({{"read", 0.25}, {"bake", 0.625}}));
}

TEST(ReportJson, NamesThatAreNoUtf8_GiveValidJson) {
  Comparison c = small_comparison();
  c.input = "caf\xE9 \"\\\n\x01.ply";
  c.light_names[0] = "\xFF\xC0\x80";
  c.command = "lambake compare \xED\xA0\x80";
  const json report = json::parse(report_json(c));
  EXPECT_EQ(report["input"], "caf\uFFFD \"\\\n\x01.ply");
}

}  // namespace
}  // namespace lambake
