/// What interpolating colours loses: the closed forms, over the parameter that breaks it.
#include <algorithm>

#include "cases.h"
#include "lambake/geometry/creases.h"

namespace lambake {
namespace {

TEST(Interpolation, LampOverABigFace_AnyDecayAndSize_MissesTheMiddleByItsClosedForm) {
  // Light at the middle: h^−k; at the corners (d² = 2a² + h²): h/d · d^−k.
  for (const float k : {0.0f, 0.5f, 1.0f, 2.0f, 4.0f})
    for (const double ratio : {0.125, 0.5, 1.0, 2.0, 8.0}) {
      const Scene scene = scene_of(grid(1, static_cast<float>(ratio)), {lamp({0, 1, 0}, 1, k)});
      SCOPED_TRACE(testing::Message() << "k " << k << ", a/h " << ratio);
      expect_max(measure(scene), 1 - std::pow(1 + 2 * ratio * ratio, -(k + 1) / 2));
    }
}

TEST(Interpolation, TerminatorThroughASphere_ErrorIsTheKinkOfTheWorstEdge) {
  // Along an edge lit at one end (s) and dark at the other (−t) the light ends where the interpolated cosine
  // is 0, but the interpolated colour is still s·t/(s + t). The curvature of the normals adds little to it.
  for (unsigned level = 1; level <= 5; ++level) {
    const Scene scene = scene_of(icosphere(level), {sun({0.4f, 1, 0.3f})});
    const glm::dvec3 w(scene.lights[0].direction_to_light);
    double kink = 0;
    for (const glm::uvec3& t : scene.mesh.triangles)
      for (int c = 0; c < 3; ++c) {
        const double s = glm::dot(glm::dvec3(scene.mesh.normals[t[c]]), w);
        const double u = -glm::dot(glm::dvec3(scene.mesh.normals[t[(c + 1) % 3]]), w);
        if (s > 0 && u > 0) kink = std::max(kink, s * u / (s + u));
      }
    SCOPED_TRACE(testing::Message() << "level " << level);
    expect_max(measure(scene), kink);
  }
}

TEST(Interpolation, TerminatorThroughASphere_FallsOnlyWithTheEdge_AndShowsOnScreen) {
  double previous = 1;
  for (unsigned level = 2; level <= 5; ++level) {
    const Scene scene = scene_of(icosphere(level), {sun({0.4f, 1, 0.3f})});
    const double on_screen = surface_error(scene, bake(scene, {}), ErrorSpace::display).max_sampled * 255;
    EXPECT_LT(on_screen, previous * 255);
    EXPECT_GT(on_screen, 10) << level;  // Steps of 1/255: far from invisible even with 20,480 triangles.
    previous = on_screen / 255;
  }
}

TEST(Interpolation, NormalsSpreadAlongAnEdge_LoseOneMinusTheCosineOfHalf) {
  for (const double degrees : {1.0, 10.0, 45.0, 90.0, 135.0, 170.0}) {
    const auto half = static_cast<float>(degrees * pi / 360);
    Mesh mesh = two_triangles();
    const glm::vec3 back(0, std::cos(half), -std::sin(half)), front(0, std::cos(half), std::sin(half));
    mesh.normals = {back, front, front, front};
    // Both triangles have the edge; the normals elsewhere stay within the spread.
    SCOPED_TRACE(testing::Message() << degrees);
    expect_max(measure(scene_of(mesh, {sun({0, 1, 0})})), 1 - std::cos(double(half)));
  }
}

TEST(Interpolation, OppositeNormals_WhereTheInterpolatedOneVanishes_StayFiniteAndBounded) {
  for (const double degrees : {179.0, 179.9, 179.999, 180.0}) {
    const auto half = static_cast<float>(degrees * pi / 360);
    Mesh mesh = two_triangles();
    const glm::vec3 back(0, std::cos(half), -std::sin(half)), front(0, std::cos(half), std::sin(half));
    mesh.normals = {back, front, front, back};
    SCOPED_TRACE(testing::Message() << degrees);
    const Measured m = measure(scene_of(mesh, {sun({0, 1, 0})}));
    EXPECT_LE(m.error.max_sampled, 1);
    EXPECT_LE(m.bound.max_bound, 2);  // No cosine is above 1; enclosures are loose where the normal vanishes.
  }
}

TEST(Interpolation, OneDarkCornerOfAQuad_TheDiagonalDecidesTheMiddle) {
  // Three corners face the sun, one is edge-on. Cut between two lit corners the middle is 1, else 1/2.
  Mesh mesh = grid(1, 1);
  mesh.normals.assign(4, {0, 1, 0});
  mesh.normals[3] = {1, 0, 0};
  for (const bool is_flipped : {false, true}) {
    if (is_flipped) mesh.triangles = {{0, 2, 1}, {1, 2, 3}};
    const Scene scene = scene_of(mesh, {sun({0, 1, 0})});
    const std::vector<LinearRgb> colors = bake(scene, {}).colors;
    const glm::uvec3& t = mesh.triangles[0];
    const float middle =
        is_flipped ? (colors[t.y].r + colors[t.z].r) / 2 : (colors[t.x].r + colors[t.z].r) / 2;
    EXPECT_FLOAT_EQ(middle, is_flipped ? 1.0f : 0.5f);
  }
}

TEST(Interpolation, FlatFacesUnderSuns_HaveNoErrorAtAll) {
  Mesh mesh = cube(21);
  split_creases(mesh, 0.5f);
  for (const BakeMethod method : every_method) {
    const Measured m = measure(scene_of(mesh, {sun({0.3f, 0.8f, -0.5f}), sun({-1, 2, 3}, 0.2f)}), method);
    EXPECT_LT(m.error.max_sampled, 1e-6);
    EXPECT_LT(m.bound.max_bound, 1e-5);
  }
}

TEST(Interpolation, FanOfACubeCorner_LeansByTheWeighting_AndWithItTheLight) {
  // Vertex 0 of cube(0) under a sun along its diagonal: exactly lit by angle, cos of the lean otherwise.
  const Light light = sun({-1, -1, -1});
  for (unsigned split = 0; split < 64; ++split) {
    Mesh mesh = cube(split);
    EXPECT_NEAR(bake(scene_of(mesh, {light}), {}).colors[0].r, 1, 1e-6);
    mesh.normals = vertex_normals(mesh, NormalWeight::uniform).normals;
    const float lit = bake(scene_of(mesh, {light}), {}).colors[0].r;
    // (1,1,1), (1,2,2) and (1,1,2) triangles on the three sides: 0, 15.79 and 19.47 degrees.
    const std::array known = {1.0, 5 / (3 * std::sqrt(3.0)), 4 / std::sqrt(18.0)};
    EXPECT_TRUE(std::any_of(known.begin(), known.end(), [&](double c) { return std::abs(lit - c) < 1e-6; }))
        << lit;
  }
}

}  // namespace
}  // namespace lambake
