/// Colours that a sum, a product or a file cannot hold: what is promised of them, for every method.
#include <unistd.h>

#include <filesystem>
#include <limits>
#include <string>

#include "cases.h"
#include "lambake/io/gltf.h"
#include "lambake/io/ply_write.h"
#include "lambake/io/scene_file.h"
#include "lambake/measure/error_shares.h"
#include "lambake/measure/surface_error.h"
#include "measure/storing.h"

namespace lambake {
namespace {

TEST(ManyLights, AHundredThousandWeakSuns_AddUpToWhatOneStrongOneGives) {
  constexpr int n = 100'000;
  const std::vector<Light> weak(n, sun({0.6f, 0.8f, 0}, 1.0f / n));
  const Scene many = scene_of(grid(1, 1), weak);
  // Float sums of n equal terms drift by up to n/2 half ulps of the sum: 0.3 %; measured 0.1 %. On screen
  // that is a tenth of a step.
  for (const BakeMethod method : every_method)
    for (const LinearRgb& c : bake(many, {.method = method}).colors) EXPECT_NEAR(c.r, 0.8, 0.8 * 2e-3);
}

TEST(ManyLights, AHundredThousandWeakLamps_InOnePlace_GiveWhatOneStrongOneGives) {
  // Summed one by one, or taken together within what the options allow.
  constexpr int n = 100'000;
  const Scene one = scene_of(grid(2, 1), {lamp({0.3f, 2, 0.1f}, 1)});
  const Scene many = scene_of(grid(2, 1), std::vector<Light>(n, lamp({0.3f, 2, 0.1f}, 1.0f / n)));
  const std::vector<LinearRgb> expected = bake(one, {}).colors;
  for (const double tolerance : {0.0, 0.25 / 255}) {
    const BakedColors baked = bake(many, {.light_tolerance = tolerance});
    for (std::size_t v = 0; v < expected.size(); ++v)
      EXPECT_NEAR(baked.colors[v].r, expected[v].r, 2e-3 * expected[v].r + baked.light_error.linear);
  }
}

TEST(ColoursThatCancel, LightOnASurfaceOfTheOppositeColour_IsBlack_WithoutError) {
  Scene scene = scene_of(icosphere(2), {sun({0.4f, 1, 0.3f}), lamp({1.5f, 2, -1}, 2)});
  for (Light& light : scene.lights) light.intensity = light.intensity * LinearRgb{1, 0, 0};
  scene.mesh.colors.assign(scene.mesh.n_vertices(), {0, 1, 1});
  for (const BakeMethod method : every_method) {
    const Measured m = measure(scene, method);
    for (const LinearRgb& c : m.baked.colors) EXPECT_EQ(c, LinearRgb{});
    EXPECT_EQ(m.error.max_sampled, 0);
    EXPECT_EQ(m.bound.max_bound, 0);
  }
}

TEST(ColoursThatCancel, WhereColourAndLightTakeTurns_TheProductIsMissed) {
  // White and edge-on at one end, black and facing the sun at the other: black at both, but between them
  // b(1 − b)/√(b² + (1 − b)²), at most √2/4. Times the light, so that the sweep is one of brightness.
  for (const float intensity : {0.01f, 0.1f, 1.0f, 100.0f}) {
    Mesh mesh = grid(1, 1);
    mesh.normals.resize(4);
    mesh.colors.resize(4);
    for (std::size_t v = 0; v < 4; ++v) {
      const bool is_left = mesh.positions[v].x < 0;
      mesh.normals[v] = is_left ? glm::vec3(-1, 0, 0) : glm::vec3(0, 1, 0);
      mesh.colors[v] = is_left ? LinearRgb{1, 1, 1} : LinearRgb{};
    }
    const Scene scene = scene_of(mesh, {sun({0, 1, 0}, intensity)});
    const Measured sample = measure(scene);
    for (const LinearRgb& c : sample.baked.colors) EXPECT_EQ(c, LinearRgb{});
    expect_max(sample, intensity * std::sqrt(2.0) / 4);
    EXPECT_LT(measure(scene, BakeMethod::least_squares).error.rmse, 0.8 * sample.error.rmse);
    EXPECT_LT(measure(scene, BakeMethod::uniform).error.rmse, 0.5 * sample.error.rmse);
    EXPECT_TRUE(is_certified(measure(scene, BakeMethod::adaptive)));
  }
}

TEST(Overflow, LightsAsStrongAsAFloatHolds_LeaveNoColourThatIsNotFinite) {
  // The sum of what two of them give is not a float any more.
  const LinearRgb strongest = LinearRgb{1, 1, 1} * std::numeric_limits<float>::max();
  for (const bool is_lamp : {false, true}) {
    Scene scene = scene_of(grid(1, 1), {sun({0, 1, 0}), sun({0.1f, 1, 0}), sun({0, 1, 0.2f})});
    if (is_lamp) scene.lights.assign(3, lamp({0, 1, 0}, 1, 0));
    scene.lights[0].intensity = scene.lights[2].intensity = strongest;
    for (const BakeMethod method : every_method)
      for (const LinearRgb& c : bake(scene, {.method = method, .max_vertices = 100}).colors)
        EXPECT_TRUE(is_finite(c)) << static_cast<int>(method) << (is_lamp ? " lamps" : " suns");
  }
}

TEST(Clipping, ColoursAboveOne_AreKeptInside_ClippedAndCountedInFiles) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("lambake-test-stability-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  SceneFile file;
  file.scene = scene_of(grid(1, 1), {sun({0, 1, 0}, 3)});
  const BakedColors baked = bake(file.scene, {});
  EXPECT_FLOAT_EQ(baked.colors[0].r, 3);
  const std::string ply = (folder / "a.ply").string(), glb = (folder / "a.glb").string();
  EXPECT_EQ(write_ply_file(ply, file.scene, baked, {}).clipped_vertices, 4U);
  EXPECT_EQ(write_gltf_file(glb, file, baked, {}).clipped_vertices, 4U);
  EXPECT_EQ(write_ply_file(ply, file.scene, baked, {.color = ColorStorage::f32}).clipped_vertices, 0U);
  for (const LinearRgb& c : read_scene_file(glb).scene.mesh.colors) EXPECT_EQ(c, (LinearRgb{1, 1, 1}));
  std::filesystem::remove_all(folder);
}

TEST(Clipping, BrighterAndBrighter_EachMethodsColoursAreClippedAndCounted_AndTheLossIsTold) {
  // A flat face under a sun of the colour (1, 1/2, 1/4) times i has the colour i·(1, 1/2, 1/4): what is above
  // 1 is cut off channel by channel, so that it turns white.
  const auto clip = [](const LinearRgb& c) {
    return LinearRgb{std::min(c.r, 1.0f), std::min(c.g, 1.0f), std::min(c.b, 1.0f)};
  };
  for (const float i : {0.5f, 1.0f, 1.5f, 3.0f, 1e3f, 1e30f}) {
    Scene scene = scene_of(grid(1, 1), {sun({0, 1, 0})});
    scene.lights[0].intensity = {i, i / 2, i / 4};
    const LinearRgb kept = clip(scene.lights[0].intensity);
    const glm::dvec3 lost(double(i) - kept.r, double(i) / 2 - kept.g, double(i) / 4 - kept.b);
    for (const BakeMethod method : every_method) {
      const BakedColors baked = bake(scene, {.method = method});
      for (const LinearRgb& c : baked.colors) {
        EXPECT_NEAR(c.r, i, 1e-6 * i);
        EXPECT_NEAR(clip(c).b, kept.b, 1e-6);
      }
      const ErrorShares shares =
          error_shares(scene, baked, storing(clip), surface_error(scene, baked, ErrorSpace::linear).rmse);
      EXPECT_NEAR(shares.clipping, glm::length(lost) / std::sqrt(3.0), 1e-6 * i) << i;
      EXPECT_LT(shares.interpolation, 1e-6 * i);
    }
  }
}

TEST(Storage, InTheDark_EachMethodsColoursLoseHalfAStepAtMost_AndCuttingForItIsNotTried) {
  const auto as_u8 = [](const LinearRgb& c) {
    const auto rounded = [](float x) { return std::round(std::clamp(x, 0.0f, 1.0f) * 255) / 255; };
    return LinearRgb{rounded(c.r), rounded(c.g), rounded(c.b)};
  };
  const std::size_t n_sound =
      bake(scene_of(icosphere(2), {sun({0.4f, 1, 0.3f})}), {.method = BakeMethod::adaptive}).colors.size();
  for (const float dark : {1.0f, 0.1f, 0.01f, 0.003f, 0.0019f}) {
    const Scene scene = scene_of(icosphere(2), {sun({0.4f, 1, 0.3f}, dark)});
    for (const BakeMethod method : every_method) {
      BakedColors baked = bake(scene, {.method = method, .output = storing(as_u8)});
      const ErrorShares shares =
          error_shares(scene, baked, storing(as_u8), surface_error(scene, baked, ErrorSpace::linear).rmse);
      EXPECT_LE(shares.quantisation, 0.5 / 255 + 1e-9);
      if (method != BakeMethod::adaptive) continue;
      // On screen half a step at black is 12.92/510 = 6.5/255: no mesh brings that below 1/255.
      EXPECT_FALSE(baked.certificate->is_certified) << dark;
      take_stored_colors(scene, storing(as_u8), baked);
      // What is open is told closely all the same.
      EXPECT_LE(baked.certificate->max_bound,
                1.2 * surface_error(scene, baked, ErrorSpace::display).max_sampled)
          << dark;
      // A few cuts lie elsewhere, as stored colours of a quarter of the tolerance off are balanced otherwise.
      EXPECT_LE(baked.colors.size(), n_sound + n_sound / 20) << dark;
    }
  }
}

TEST(Storage, InTheDark_LosesWhatItsStepsAre) {
  // Half a step of the storage, relative to the colour: 1/510 linear for u8, 1/131070 for u16; sRGB for PLY.
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("lambake-test-storage-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const std::string ply = (folder / "a.ply").string(), glb = (folder / "a.glb").string();
  double worst_u8 = 0, worst_u16 = 0, worst_srgb = 0;
  for (const float dark : {0.0098f, 0.0099f, 0.01f, 0.0101f, 0.0102f}) {
    SceneFile file;
    file.scene = scene_of(grid(1, 1), {sun({0, 1, 0}, dark)});
    const BakedColors baked = bake(file.scene, {});
    const auto loss = [&](const std::string& path) {
      return std::abs(double(read_scene_file(path).scene.mesh.colors.at(0).r) - dark) / dark;
    };
    write_gltf_file(glb, file, baked, {.color = ColorStorage::u8});
    worst_u8 = std::max(worst_u8, loss(glb));
    write_gltf_file(glb, file, baked, {.color = ColorStorage::u16});
    worst_u16 = std::max(worst_u16, loss(glb));
    write_ply_file(ply, file.scene, baked, {});
    worst_srgb = std::max(worst_srgb, loss(ply));
    write_gltf_file(glb, file, baked, {.color = ColorStorage::f32});
    EXPECT_EQ(loss(glb), 0);
  }
  EXPECT_GT(worst_u8, 0.15);
  EXPECT_LT(worst_u8, 0.21);
  EXPECT_GT(worst_srgb, 0.002);
  EXPECT_LT(worst_srgb, 0.03);
  EXPECT_LT(worst_u16, 0.0008);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace lambake
