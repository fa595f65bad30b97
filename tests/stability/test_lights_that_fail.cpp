/// Lights in the places that break lighting: what is promised of them, for every method.
#include <unistd.h>

#include <filesystem>
#include <limits>
#include <string>

#include "cases.h"
#include "lambake/io/gltf.h"
#include "lambake/io/ply_write.h"
#include "lambake/io/scene_file.h"
#include "lambake/shading/lambert.h"

namespace lambake {
namespace {

Light spot(const glm::vec3& position, float outer_deg) {
  Light light = lamp(position);
  light.type = LightType::spot;
  light.spot_direction = {0, -1, 0};
  light.outer_cone_rad = outer_deg * static_cast<float>(pi) / 180;
  return light;
}

TEST(LampOnTheSurface, OnAVertex_GivesNothingToIt_AndTheErrorIsReportedAsUnbounded) {
  for (const float k : {0.5f, 1.0f, 2.0f, 4.0f}) {
    const Scene scene = scene_of(icosphere(2), {lamp(icosphere(2).positions[7], 1, k)});
    const Measured m = measure(scene);
    EXPECT_EQ(m.baked.colors[7], LinearRgb{});
    EXPECT_GT(m.bound.unbounded_triangles, 0U) << k;
  }
}

TEST(LampOnTheSurface, InsideAFaceOrOnAnEdge_IsReportedAsUnbounded) {
  // Flat, with normals as of something rounded: around the lamp light grows without limit on one side.
  Mesh mesh = two_triangles();
  mesh.normals = {{0, 0.8f, -0.6f}, {0, 0.8f, 0.6f}, {0.6f, 0.8f, 0}, {-0.6f, 0.8f, 0}};
  for (const glm::vec3& place : {glm::vec3(0.25f, 0, 0.125f), glm::vec3(0, 0, 0.5f)}) {
    const Measured m = measure(scene_of(mesh, {lamp(place)}));
    EXPECT_GT(m.bound.unbounded_triangles, 0U);
    EXPECT_EQ(m.bound.max_bound, std::numeric_limits<double>::infinity());
  }
}

TEST(LampOnTheSurface, InTheMiddleOfAFlatSheet_LightsNothing_AsAllOfItIsEdgeOn) {
  for (const glm::vec3& place : {glm::vec3(0), glm::vec3(0.5f, 0, 0), glm::vec3(0.25f, 0, 0.125f)})
    for (const BakeMethod method : every_method) {
      const Measured m = measure(scene_of(grid(1, 1), {lamp(place)}), method);
      for (const LinearRgb& c : m.baked.colors) EXPECT_EQ(c, LinearRgb{});
      EXPECT_EQ(m.error.max_sampled, 0);
    }
}

TEST(LampNearTheSurface, AsItComesCloser_TheErrorGrowsByItsClosedForm) {
  // At height h over the middle of the square of half side 1: 1/h² there, almost nothing at the corners.
  for (const double h : {0.5, 0.1, 0.02}) {
    const Scene scene = scene_of(grid(1, 1), {lamp({0, static_cast<float>(h), 0})});
    const double truth = 1 / (h * h) - h / std::pow(2 + h * h, 1.5);
    SCOPED_TRACE(testing::Message() << h);
    const Measured m = measure(scene);
    EXPECT_LE(m.error.max_sampled, truth * (1 + 1e-5));
    EXPECT_GE(m.error.max_sampled, 0.9 * truth);
    EXPECT_GE(m.bound.max_bound, truth * (1 - 1e-6));
    EXPECT_LE(m.bound.max_bound, 1.2 * truth);
  }
}

TEST(LampBehind, InsideAClosedMesh_OrUnderASheet_LightsNothing_WithoutError) {
  for (const Scene& scene :
       {scene_of(icosphere(3), {lamp({0.1f, 0.2f, -0.1f})}), scene_of(grid(4, 1), {lamp({0.3f, -1, 0})}),
        scene_of(grid(4, 1), {sun({0.2f, -1, 0})})})
    for (const BakeMethod method : every_method) {
      const Measured m = measure(scene, method);
      for (const LinearRgb& c : m.baked.colors) EXPECT_EQ(c, LinearRgb{});
      EXPECT_EQ(m.error.max_sampled, 0);
    }
}

TEST(GrazingLight, FlatSheet_GetsTheSineOfTheAngle_DownToTheLast) {
  for (const double angle : {1e-1, 1e-3, 1e-5, 1e-7}) {
    const Scene scene = scene_of(
        grid(2, 1), {sun({static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0})});
    for (const BakeMethod method : every_method)
      for (const LinearRgb& c : measure(scene, method).baked.colors)
        EXPECT_NEAR(c.r, std::sin(angle), 1e-6 * std::sin(angle)) << angle;
  }
}

TEST(RangeEdge, ALampThatReachesNoVertex_IsMissedWhole_ByEveryVertex) {
  for (const float range : {1.01f, 1.2f, 1.4f}) {  // The corners of the square are √3 away.
    Light light = lamp({0, 1, 0});
    light.range = range;
    const Scene scene = scene_of(grid(1, 1), {light});
    const Measured m = measure(scene);
    for (const LinearRgb& c : m.baked.colors) EXPECT_EQ(c, LinearRgb{});
    SCOPED_TRACE(range);
    const double truth = 1 - std::pow(double(range), -4);
    EXPECT_LE(m.error.max_sampled, truth * (1 + 1e-5));
    EXPECT_GE(m.bound.max_bound, truth * (1 - 1e-6));
    EXPECT_LE(m.bound.max_bound, 1.2 * truth + 1e-6);
  }
}

TEST(ConeEdge, ASpotBetweenTheVertices_IsMissedWhole_HoweverNarrow_AndBounded) {
  for (const float outer_deg : {30.0f, 10.0f, 3.0f, 1.0f, 0.5f}) {
    const Scene scene = scene_of(grid(1, 1), {spot({0.3f, 1, 0.2f}, outer_deg)});
    const Measured m = measure(scene);
    for (const LinearRgb& c : m.baked.colors) EXPECT_EQ(c, LinearRgb{});
    // Straight under it (narrow cones do not reach full light). Sampling may miss it; the bound may not.
    const double truth = received<double>(scene.lights[0], glm::dvec3(0.3f, 0, 0.2f), glm::dvec3(0, 1, 0));
    EXPECT_GT(truth, 1e-3);
    EXPECT_LE(m.error.max_sampled, truth * (1 + 1e-5)) << outer_deg;
    EXPECT_GE(m.bound.max_bound, truth * (1 - 1e-6)) << outer_deg;
    EXPECT_LE(m.bound.max_bound, 1.3 * truth) << outer_deg;
  }
}

TEST(ManyLights, AHundredThousandWeakSuns_AddUpToWhatOneStrongOneGives) {
  constexpr int n = 100'000;
  const std::vector<Light> weak(n, sun({0.6f, 0.8f, 0}, 1.0f / n));
  const Scene many = scene_of(grid(1, 1), weak);
  // Float sums of n equal terms drift by up to n/2 half ulps of the sum: 0.3 %; measured 0.1 %. On screen
  // that is a tenth of a step.
  EXPECT_NEAR(bake(many, {}).colors[0].r, 0.8, 0.8 * 2e-3);
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
