/// Lights in the places that break lighting: what is promised of them, for every method.
#include <limits>

#include "cases.h"
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
    for (const BakeMethod method : every_method) {
      const Measured m = measure(scene, method);
      if (method == BakeMethod::sample || method == BakeMethod::uniform || method == BakeMethod::adaptive) {
        EXPECT_EQ(m.baked.colors[7], LinearRgb{});
      }
      EXPECT_GT(m.bound.unbounded_triangles, 0U) << k;
      EXPECT_FALSE(is_certified(m));
    }
  }
}

TEST(LampOnTheSurface, WithoutFalloff_HasABound) {
  // k = 0: light does not grow towards the lamp, only its direction turns.
  for (const BakeMethod method : every_method) {
    const Measured m = measure(scene_of(icosphere(2), {lamp(icosphere(2).positions[7], 1, 0)}), method);
    EXPECT_EQ(m.bound.unbounded_triangles, 0U);
    EXPECT_LE(m.bound.max_bound, 1.5);
  }
}

TEST(LampOnTheSurface, InsideAFaceOrOnAnEdge_IsReportedAsUnbounded) {
  // Flat, with normals as of something rounded: around the lamp light grows without limit on one side.
  Mesh mesh = two_triangles();
  mesh.normals = {{0, 0.8f, -0.6f}, {0, 0.8f, 0.6f}, {0.6f, 0.8f, 0}, {-0.6f, 0.8f, 0}};
  for (const glm::vec3& place : {glm::vec3(0.25f, 0, 0.125f), glm::vec3(0, 0, 0.5f)})
    for (const BakeMethod method : every_method) {
      const Measured m = measure(scene_of(mesh, {lamp(place)}), method);
      EXPECT_GT(m.bound.unbounded_triangles, 0U);
      EXPECT_EQ(m.bound.max_bound, std::numeric_limits<double>::infinity());
      EXPECT_FALSE(is_certified(m));
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
    for (const BakeMethod method : every_method) measure(scene, method);
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

TEST(GrazingLight, LampBesideAFlatSheet_GetsItsHeightOverTheDistance_DownToTheLast) {
  // Beside the sheet, so that the light is smooth on it: h/d³ at each vertex, however low it stands.
  for (const float height : {1.0f, 1e-2f, 1e-4f, 1e-6f}) {
    const Scene scene = scene_of(grid(4, 1), {lamp({2, height, 0})});
    const Measured sample = measure(scene);
    for (std::size_t v = 0; v < scene.mesh.n_vertices(); ++v) {
      const double d = glm::length(glm::dvec3(2, height, 0) - glm::dvec3(scene.mesh.positions[v]));
      EXPECT_NEAR(sample.baked.colors[v].r, height / (d * d * d), 1e-6 * height);
    }
    for (const BakeMethod method : every_method) {
      const Measured m = measure(scene, method);
      EXPECT_LT(m.error.max_sampled, height);  // The error is in proportion to the light.
      EXPECT_LT(m.bound.max_bound, 2 * height);
    }
    EXPECT_TRUE(is_certified(measure(scene, BakeMethod::adaptive)));
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
    for (const BakeMethod method : every_method) measure(scene, method);
    EXPECT_TRUE(is_certified(measure(scene, BakeMethod::adaptive)));
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
    for (const BakeMethod method : every_method) measure(scene, method);
    EXPECT_TRUE(is_certified(measure(scene, BakeMethod::adaptive))) << outer_deg;
  }
}

}  // namespace
}  // namespace lambake
