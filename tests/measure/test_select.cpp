#include "lambake/measure/select.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lambake/measure/surface_error.h"
#include "scenes.h"
#include "storing.h"

namespace lambake {
namespace {

TEST(SelectMethod, FlatGridUnderASun_NeedsNoMoreThanSampling) {
  const Selection selection = select_method(scene_of(grid(4, 1), {sun({0.4f, 1, 0.3f})}), {});
  ASSERT_EQ(selection.trials.size(), 2U);  // What comes behind could not be smaller.
  EXPECT_TRUE(selection.is_certified);
  const MethodTrial& chosen = selection.trials[selection.chosen];
  EXPECT_TRUE(chosen.is_certified);
  for (const MethodTrial& trial : selection.trials)
    EXPECT_TRUE(!trial.is_certified || chosen.bytes <= trial.bytes);
  EXPECT_NE(selection.sentence.find("suffices"), std::string::npos);
}

TEST(SelectMethod, SphereUnderASun_NeedsCuts) {
  const Scene scene = scene_of(icosphere(3), {sun({0.4f, 1, 0.3f})});
  const Selection selection = select_method(scene, {});
  EXPECT_TRUE(selection.is_certified);
  EXPECT_EQ(selection.trials[selection.chosen].method, BakeMethod::adaptive);
  EXPECT_LE(surface_error(scene, selection.baked, ErrorSpace::display).max_sampled, 1.0 / 255);
  EXPECT_NE(selection.sentence.find("642 → "), std::string::npos) << selection.sentence;
  for (const MethodTrial& trial : selection.trials) EXPECT_GE(trial.max_bound, trial.max_found);
}

TEST(SelectMethod, VerticesLimitedByTheCaller_DecidesNothing) {
  const Scene scene = scene_of(icosphere(2), {sun({0.4f, 1, 0.3f})});
  const Selection selection = select_method(scene, {.max_vertices = 170});
  EXPECT_FALSE(selection.is_certified);
  EXPECT_EQ(selection.sentence.rfind("not decided with at most 170 vertices", 0), 0U) << selection.sentence;
  EXPECT_LE(selection.baked.mesh->n_vertices(), 170U);
}

TEST(SelectMethod, LampOnTheSurface_SaysThatPixelsAreNeeded) {
  Light lamp;
  lamp.type = LightType::point;
  lamp.position = {0, 1, 0};
  const Selection selection = select_method(scene_of(icosphere(1), {lamp}), {});
  EXPECT_FALSE(selection.is_certified);
  EXPECT_EQ(selection.sentence.rfind("per-pixel lighting is needed", 0), 0U) << selection.sentence;
}

TEST(SelectMethod, LightThatOneOutputClips_IsLeftForOthers) {
  Scene scene = scene_of(icosphere(3), {sun({0.4f, 1, 0.3f})});
  scene.lights[0].intensity = {6, 6, 6};
  ColorOutput output;
  output.shown = [](const LinearRgb& color, const Material&) {
    return glm::dvec3(std::min(color.r, 1.0f), std::min(color.g, 1.0f), std::min(color.b, 1.0f));
  };
  const auto brightest = [](const BakedColors& baked) {
    float most = 0;
    for (const LinearRgb& c : baked.colors) most = std::max(most, c.r);
    return most;
  };
  EXPECT_GT(brightest(select_method(scene, {.output = output}).baked), 1.5f);
  BakeOptions options{.method = BakeMethod::adaptive, .output = output};
  BakedColors baked = bake(scene, options);
  EXPECT_GT(brightest(baked), 1.5f);
  // What the output makes of them is what is certified.
  ASSERT_TRUE(baked.certificate->is_certified);
  take_stored_colors(scene, output, baked);
  EXPECT_EQ(brightest(baked), 1.0f);
  EXPECT_LE(surface_error(scene, baked, ErrorSpace::display).max_sampled, 1.0 / 255);
}

// Colours in sixteenths: most of what is left is rounding, and light per pixel is not what is missing.
TEST(SelectMethod, MostlyRounding_DecidesNothing) {
  const Scene scene = scene_of(icosphere(3), {sun({0.4f, 1, 0.3f})});
  const ColorOutput coarse = storing([](const LinearRgb& c) {
    const auto rounded = [](float channel) { return std::round(channel * 16) / 16; };
    return LinearRgb{rounded(c.r), rounded(c.g), rounded(c.b)};
  });
  const Selection rounded = select_method(scene, {.output = coarse});
  EXPECT_NE(rounded.sentence.find("would do for"), std::string::npos) << rounded.sentence;
  const Selection both = select_method(scene, {.max_vertices = 670, .output = coarse});
  EXPECT_EQ(both.sentence.rfind("not decided: ", 0), 0U) << both.sentence;
  EXPECT_NE(both.sentence.find("mostly as the output rounds"), std::string::npos) << both.sentence;
}

TEST(SelectMethod, LightAboveWhite_NamesTheExposure) {
  const Scene scene = scene_of(icosphere(3), {sun({0.4f, 1, 0.3f}, {0.99f, 0.99f, 0.99f})});
  const ColorOutput narrow = storing([](const LinearRgb& c) {
    return LinearRgb{std::min(c.r, 0.9f), std::min(c.g, 0.9f), std::min(c.b, 0.9f)};
  });
  // At the middle alone, where no vertex was: 0.96 there, 0.005 at the corners.
  const Scene quad = scene_of(grid(1, 1), {lamp({0, 0.25f, 0}, {0.06f, 0.06f, 0.06f})});
  for (const Scene& above : {scene, quad}) {
    const std::string sentence = select_method(above, {.output = narrow}).sentence;
    EXPECT_NE(sentence.find("clips colours; a lower exposure helps"), std::string::npos) << sentence;
  }
}

TEST(SelectMethod, NormalsThatCancel_DecideNothing) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  mesh.normals = {{0, 1, 0}, {0, 1, 0}, {0, -1, 0}};  // 0 in the middle of two sides.
  mesh.triangles = {{0, 2, 1}};
  const Selection selection = select_method(scene_of(mesh, {sun({0.4f, 1, 0.3f})}), {.max_vertices = 100});
  EXPECT_EQ(selection.sentence.rfind("not decided: ", 0), 0U) << selection.sentence;
  EXPECT_NE(selection.sentence.find("--crease-angle-deg"), std::string::npos) << selection.sentence;
}

TEST(SelectMethod, OutputWithGaps_IsChosenForByTheLight) {
  ColorOutput output;
  output.gaps = {{.code = "certificate_not_of_file", .count = 1, .text = "material emits light"}};
  const Selection sphere = select_method(scene_of(icosphere(3), {sun({0.4f, 1, 0.3f})}), {.output = output});
  EXPECT_FALSE(sphere.is_certified);
  EXPECT_EQ(sphere.trials[sphere.chosen].method, BakeMethod::adaptive);
  EXPECT_NE(sphere.sentence.find("adaptive comes nearest, its light is at most 1/255 off"), std::string::npos)
      << sphere.sentence;
  for (const MethodTrial& trial : sphere.trials) EXPECT_TRUE(std::isinf(trial.max_bound));
  ASSERT_FALSE(sphere.baked.findings.empty());
  EXPECT_EQ(std::count_if(sphere.baked.findings.begin(), sphere.baked.findings.end(),
                          [](const Finding& f) { return f.code == "certificate_not_of_file"; }),
            1);
  const Selection flat = select_method(scene_of(grid(4, 1), {sun({0.4f, 1, 0.3f})}), {.output = output});
  EXPECT_EQ(flat.trials.size(), 2U);
  EXPECT_EQ(flat.baked.findings.size(), 1U);
  const Selection few =
      select_method(scene_of(icosphere(3), {sun({0.4f, 1, 0.3f})}), {.max_vertices = 700, .output = output});
  EXPECT_NE(few.sentence.find("its light is up to"), std::string::npos) << few.sentence;
}

TEST(SelectMethod, TooLittleTime_DecidesNothing) {
  const Scene scene = scene_of(icosphere(5), {sun({0.4f, 1, 0.3f})});
  const Selection selection = select_method(scene, {.max_seconds = 1e-6});
  EXPECT_FALSE(selection.is_certified);
  EXPECT_EQ(selection.sentence.rfind("not decided in 1e-06 s", 0), 0U) << selection.sentence;
}

}  // namespace
}  // namespace lambake
