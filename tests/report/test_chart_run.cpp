#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "lambake/bake/bake.h"
#include "lambake/core/error.h"
#include "lambake/measure/surface_error.h"
#include "lambake/render/framing.h"
#include "lambake/report/chart_report.h"
#include "shapes.h"

namespace lambake {
namespace {

/// A square of two triangles whose normals lean outwards, under a sun.
Scene leaning_square() {
  Scene scene;
  scene.mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  for (const glm::vec3& p : scene.mesh.positions)
    scene.mesh.normals.push_back(glm::normalize(glm::vec3(0.6f * p.x, 0.6f * p.y, 1)));
  scene.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.materials.resize(1);
  Light sun;
  sun.direction_to_light = glm::normalize(glm::vec3(1, 0.2f, 0.3f));
  scene.lights = {sun};
  return scene;
}

Timing seconds(double median) {
  return {median, 0.9 * median, 1.2 * median, 9};
}

/// As run_chart() leaves it, by hand: per vertex gets dearer than per pixel between 10 and 1000 lights.
ChartRun small_run() {
  ChartRun run;
  run.input = "square.ply", run.command = "lambake chart square.ply -o out", run.version = "0.1.0";
  run.n_vertices = 4, run.n_triangles = 2, run.n_lights = 1, run.n_threads = 2;
  run.methods = {{"face", "", seconds(1e-3), seconds(6e-4), 6, 2, 216, 0.05, 0.2, 0.25},
                 {"sample", "", seconds(2e-3), seconds(1e-3), 4, 2, 152, 0.02, 0.1, 0.11},
                 {"sample", "normals, \"max\"", seconds(3e-3), seconds(2e-3), 4, 2, 152, 0.03, 0.1,
                  std::numeric_limits<double>::infinity()}};
  run.frames = {{640, 360, 1000, seconds(0.01), seconds(0.012), seconds(0.02), seconds(0.025)}};
  run.lights = {{10, seconds(1e-3), seconds(1e-2)}, {1000, seconds(1e-1), seconds(1e-2)}};
  run.left_out = {"adaptive, 1/255"};
  return run;
}

TEST(MeasureTime, RepeatsAtLeastThreeTimes_AfterAWarmUp) {
  int calls = 0;
  const Timing timing = measure_time([&] { ++calls; }, 1e-3);
  EXPECT_GE(timing.repeats, 3U);
  EXPECT_EQ(static_cast<std::size_t>(calls), timing.repeats + 1);
  EXPECT_LE(timing.low, timing.median);
  EXPECT_LE(timing.median, timing.high);
}

TEST(MeasureTime, LongWork_RunsOnce) {
  int calls = 0;
  EXPECT_EQ(measure_time([&] { ++calls; }, -1).repeats, 1U);
  EXPECT_EQ(calls, 1);
}

TEST(RunChart, MethodsAskedFor_AreMeasured_WithTheirErrors) {
  const Scene scene = leaning_square();
  const ChartRun run = run_chart(scene, {.methods = {"sample", "adaptive"},
                                         .budget_seconds = 20,
                                         .camera = frame(scene.mesh.positions, 16.0f / 9)});
  EXPECT_TRUE(run.left_out.empty());
  double sample_bound = 0;
  for (const MethodRun& m : run.methods) {
    EXPECT_NE(m.method, "face");
    EXPECT_GT(m.all_threads.median, 0) << m.label();
    EXPECT_LE(m.rmse, m.max_sampled) << m.label();
    EXPECT_LE(m.max_sampled, m.max_bound) << m.label();
    if (m.label() == "sample") sample_bound = m.max_bound;
    if (m.label() == "adaptive, 1/255") {
      EXPECT_LE(m.max_bound, 1.0 / 255);
      EXPECT_GT(m.n_vertices, 4U);
    }
  }
  EXPECT_GT(sample_bound, 1.0 / 255);
  ASSERT_EQ(run.frames.size(), 4U);
  EXPECT_LT(run.frames[0].n_covered, run.frames[3].n_covered);
  for (const FrameRun& f : run.frames)
    EXPECT_TRUE(f.per_vertex_one_thread.median > 0 && f.per_fragment_one_thread.median > 0);
  ASSERT_FALSE(run.lights.empty());
  EXPECT_EQ(run.lights.front().n_lights, 1U);
}

TEST(RunChart, Errors_AreOfWhatTheOutputShows) {
  Scene scene = leaning_square();
  for (Light& light : scene.lights) light.intensity = LinearRgb{3, 3, 3};
  const auto clip = [](ColorStorage) {
    ColorOutput output;
    output.shown = [](const LinearRgb& c, const Material&) {
      return glm::dvec3(std::min(c.r, 1.0f), std::min(c.g, 1.0f), std::min(c.b, 1.0f));
    };
    return output;
  };
  const auto rmse_of_sample = [&](const ChartRunOptions& options) {
    return run_chart(scene, options).methods.front().rmse;
  };
  ChartRunOptions options{.methods = {"sample"}, .budget_seconds = 2};
  options.camera = frame(scene.mesh.positions, 16.0f / 9);
  const double unclipped = rmse_of_sample(options);
  options.output = clip;
  BakedColors baked = bake(scene, {});
  take_stored_colors(scene, clip(ColorStorage::u16), baked);
  EXPECT_EQ(rmse_of_sample(options), surface_error(scene, baked, ErrorSpace::display).rmse);
  EXPECT_NE(rmse_of_sample(options), unclipped);
}

TEST(RunChart, MethodsThatTimeEnds_AreLeftOut) {
  Scene scene = leaning_square();
  scene.mesh = icosphere(5);
  scene.mesh.normals = scene.mesh.positions;
  for (int i = 0; i < 40; ++i) {
    Light light;
    light.direction_to_light = glm::normalize(glm::vec3(std::cos(i), std::sin(i), 0.1f));
    scene.lights.push_back(light);
  }
  const ChartRun run = run_chart(
      scene,
      {.methods = {"adaptive"}, .budget_seconds = 0.02, .camera = frame(scene.mesh.positions, 16.0f / 9)});
  for (const MethodRun& m : run.methods) EXPECT_NE(m.method, "adaptive");
  EXPECT_NE(std::find(run.left_out.begin(), run.left_out.end(), "adaptive, 1/255"), run.left_out.end());
}

TEST(RunChart, BudgetThatIsOver_LeavesOut_AndSaysWhat) {
  const Scene scene = leaning_square();
  const ChartRun run = run_chart(scene, {.budget_seconds = 1e-9});
  EXPECT_TRUE(run.methods.empty());
  EXPECT_EQ(run.left_out.front(), "sample");
}

TEST(RunChart, UnknownMethodOrNoBudget_Throws) {
  EXPECT_THROW(run_chart(leaning_square(), {.methods = {"magic"}}), InvalidOption);
  EXPECT_THROW(run_chart(leaning_square(), {.budget_seconds = 0}), InvalidOption);
}

TEST(ChartReport, Json_HoldsTheRun_UnboundedIsNull) {
  const auto json = nlohmann::json::parse(chart_json(small_run()));
  EXPECT_EQ(json["methods"].size(), 3U);
  EXPECT_EQ(json["methods"][1]["seconds"]["all_threads"]["median"], 1e-3);
  EXPECT_EQ(json["methods"][1]["surface_display"]["max_bound"], 0.11);
  EXPECT_TRUE(json["methods"][2]["surface_display"]["max_bound"].is_null());
  EXPECT_EQ(json["pictures"][0]["lit_pixels"], 1000);
  EXPECT_EQ(json["pictures"][0]["per_fragment"]["all_threads"]["median"], 0.012);
  EXPECT_EQ(json["pictures"][0]["per_fragment"]["one_thread"]["median"], 0.025);
  EXPECT_EQ(json["left_out"][0], "adaptive, 1/255");
}

TEST(ChartReport, Csv_QuotesWhatNeedsIt) {
  std::istringstream lines(chart_csv(small_run()));
  std::string line;
  std::vector<std::string> all;
  while (std::getline(lines, line)) all.push_back(line);
  ASSERT_EQ(all.size(), 6U);  // header, three methods, a picture both ways
  EXPECT_TRUE(all[2].starts_with("sample,,4,2,152,0.002,0.001,")) << all[2];
  EXPECT_TRUE(all[3].starts_with("sample,\"normals, \"\"max\"\"\",4,")) << all[3];
  EXPECT_TRUE(all[3].ends_with(",inf\r")) << all[3];
  EXPECT_TRUE(all[5].starts_with("picture per pixel,640x360,,,,0.025,0.012,")) << all[5];
}

TEST(ChartReport, LightsThatCross_AreMarkedWhereTheyCostTheSame) {
  // Log–log: −1 and +1 decades apart, so half way from 10 to 1000.
  const Chart chart = lights_chart(small_run());
  ASSERT_EQ(chart.series.size(), 3U);
  EXPECT_NEAR(chart.series[2].points[0].x, 100, 1e-9);
  EXPECT_NEAR(chart.series[2].points[0].y, 0.01, 1e-12);
  ChartRun parallel = small_run();
  parallel.lights[1].per_vertex = seconds(1e-3);
  EXPECT_EQ(lights_chart(parallel).series.size(), 2U);
}

TEST(ChartReport, MethodsWithoutABound_StayOffTheBoundChart) {
  std::size_t n = 0;
  for (const ChartSeries& series : bound_chart(small_run()).series)
    if (series.is_compared) n += series.points.size();
  EXPECT_EQ(n, 2U);
}

TEST(ChartReport, Page_SaysWhenABakeHasPaid) {
  const std::string page = chart_page(small_run());
  EXPECT_NE(page.find("it has paid for itself after the first"), std::string::npos);
  EXPECT_NE(page.find("the budget left out adaptive, 1/255"), std::string::npos);
  ChartRun slow = small_run();
  slow.methods[1].all_threads = seconds(0.0099);
  EXPECT_NE(chart_page(slow).find("after 5"), std::string::npos);
}

TEST(ChartReport, WhatPaysIsWhatTheVerdictNames) {
  ChartRun run = small_run();
  run.verdict = "face suffices", run.chosen_method = run.methods[0].method;
  run.methods[0].all_threads = seconds(0.0099);
  EXPECT_NE(chart_page(run).find("Baking by " + run.methods[0].method + " takes 9.9 ms"), std::string::npos);
  EXPECT_NE(chart_page(run).find("after 5"), std::string::npos);
}

TEST(ChartReport, WithoutAnyBoundOrPicture_NothingIsShownOfThem) {
  ChartRun run = small_run();
  EXPECT_NE(chart_page(run).find("id=\"bound\""), std::string::npos);
  EXPECT_NE(chart_page(run).find("At 0:"), std::string::npos);
  for (MethodRun& m : run.methods) m.max_bound = std::numeric_limits<double>::infinity();
  run.frames.clear();
  EXPECT_EQ(chart_page(run).find("id=\"bound\""), std::string::npos);
  EXPECT_EQ(chart_page(run).find("At 0:"), std::string::npos);
}

// So that two charts beside each other can be read together.
TEST(ChartReport, AMethod_HasOneColourAndShapeInEveryChart) {
  const auto kind_of = [](const ChartRun& run, const std::string& name) {
    for (const ChartSeries& series : speed_chart(run).series)
      if (series.name == name) return series.kind;
    return std::optional<std::size_t>();
  };
  ChartRun run = small_run();
  const auto before = kind_of(run, "sample");
  ASSERT_TRUE(before);
  std::reverse(run.methods.begin(), run.methods.end());
  EXPECT_EQ(kind_of(run, "sample"), before);
}

TEST(ChartReport, WhatRoundingLeavesOfAnError_DoesNotStretchTheAxis) {
  ChartRun run = small_run();
  run.methods[0].rmse = 1e-14;
  bool is_at_0 = false;
  for (const ChartSeries& series : speed_chart(run).series)
    for (const ChartPoint& p : series.points) is_at_0 |= series.is_compared && p.y == 0;
  EXPECT_TRUE(is_at_0);
}

TEST(ChartReport, WhatAutoTook_IsNamedAndRinged) {
  ChartRun run = small_run();
  EXPECT_EQ(chart_svg(speed_chart(run), 800, 500, true).find("<circle class=\"ring\""), std::string::npos);
  run.verdict = "sample suffices: at most 0.9/255 anywhere", run.chosen_method = "sample";
  EXPECT_NE(chart_page(run).find("<h1>Within 1/255: sample suffices: at most 0.9/255 anywhere.</h1>"),
            std::string::npos);
  std::size_t n_rings = 0;
  for (const ChartSeries& series : speed_chart(run).series)
    for (const ChartPoint& p : series.points) n_rings += p.is_emphasised;
  EXPECT_EQ(n_rings, 1U);
}

}  // namespace
}  // namespace lambake
