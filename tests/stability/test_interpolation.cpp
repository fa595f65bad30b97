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
      for (const BakeMethod method : every_method) measure(scene, method);
      EXPECT_TRUE(is_certified(measure(scene, BakeMethod::adaptive)));
    }
}

TEST(Interpolation, LampOverABigFace_EachMethod_MissesWhatItDoesNotLookAt_AndCutsMendIt) {
  for (const double ratio : {0.5, 1.0, 2.0}) {
    SCOPED_TRACE(testing::Message() << "a/h " << ratio);
    const Scene scene = scene_of(grid(1, static_cast<float>(ratio)), {lamp({0, 1, 0})});
    // d² at the centroids of both triangles is 1 + 2a²/9; `average` has that colour at all four corners too.
    const double corner = std::pow(1 + 2 * ratio * ratio, -1.5);
    const double centroid = std::pow(1 + 2 * ratio * ratio / 9, -1.5);
    for (const BakeMethod method : {BakeMethod::face, BakeMethod::average})
      expect_max(measure(scene, method), std::max(1 - centroid, centroid - corner));
    const Measured sample = measure(scene);
    EXPECT_LT(measure(scene, BakeMethod::least_squares).error.rmse, sample.error.rmse);
    EXPECT_LT(measure(scene, BakeMethod::uniform).error.rmse, 0.7 * sample.error.rmse);
    EXPECT_TRUE(is_certified(measure(scene, BakeMethod::adaptive)));
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

TEST(Interpolation, TerminatorThroughASphere_EachMethod_IsAsGoodAsItIsSaidToBe) {
  for (unsigned level = 1; level <= 3; ++level) {
    SCOPED_TRACE(testing::Message() << "level " << level);
    const Scene scene = scene_of(icosphere(level), {sun({0.4f, 1, 0.3f})});
    const Measured sample = measure(scene);
    EXPECT_GT(measure(scene, BakeMethod::face).error.rmse, 1.4 * sample.error.rmse);
    EXPECT_GT(measure(scene, BakeMethod::average).error.rmse, 1.4 * sample.error.rmse);
    EXPECT_LT(measure(scene, BakeMethod::least_squares).error.rmse, 0.8 * sample.error.rmse);
    // The kink halves with the edge, however often all is quartered: by the edge that is cut worst.
    const double uniform = measure(scene, BakeMethod::uniform).error.max_sampled;
    EXPECT_GT(uniform, 0.3 * sample.error.max_sampled);
    EXPECT_LT(uniform, 0.8 * sample.error.max_sampled);
    const Measured adaptive = measure(scene, BakeMethod::adaptive);
    EXPECT_TRUE(is_certified(adaptive));
    EXPECT_LT(adaptive.baked.mesh->n_triangles(), scene.mesh.n_triangles() + 700);
  }
}

TEST(Interpolation, SunsFromOppositeSides_TheirKinksAddUp) {
  // |n·ω|: at the terminator of both, so the error there is twice that of one.
  const Scene one = scene_of(icosphere(3), {sun({0.4f, 1, 0.3f})});
  const Scene two = scene_of(icosphere(3), {sun({0.4f, 1, 0.3f}), sun({-0.4f, -1, -0.3f})});
  const double single = measure(one).error.max_sampled, twice = measure(two).error.max_sampled;
  EXPECT_NEAR(twice, 2 * single, 0.02 * twice);
  for (const BakeMethod method : every_method) measure(two, method);
}

TEST(Interpolation, NormalsSpreadAlongAnEdge_LoseOneMinusTheCosineOfHalf) {
  for (const double degrees : {1.0, 10.0, 45.0, 90.0, 135.0, 170.0}) {
    const auto half = static_cast<float>(degrees * pi / 360);
    Mesh mesh = two_triangles();
    const glm::vec3 back(0, std::cos(half), -std::sin(half)), front(0, std::cos(half), std::sin(half));
    mesh.normals = {back, front, front, front};
    // Both triangles have the edge; the normals elsewhere stay within the spread.
    SCOPED_TRACE(testing::Message() << degrees);
    const Scene scene = scene_of(mesh, {sun({0, 1, 0})});
    expect_max(measure(scene), 1 - std::cos(double(half)));
    for (const BakeMethod method : every_method) measure(scene, method);
    EXPECT_TRUE(is_certified(measure(scene, BakeMethod::adaptive)));
  }
}

TEST(Interpolation, OppositeNormals_WhereTheInterpolatedOneVanishes_StayFiniteAndBounded) {
  for (const double degrees : {179.0, 179.9, 179.999, 180.0}) {
    const auto half = static_cast<float>(degrees * pi / 360);
    Mesh mesh = two_triangles();
    const glm::vec3 back(0, std::cos(half), -std::sin(half)), front(0, std::cos(half), std::sin(half));
    mesh.normals = {back, front, front, back};
    SCOPED_TRACE(testing::Message() << degrees);
    for (const BakeMethod method : every_method) {
      const Measured m = measure(scene_of(mesh, {sun({0, 1, 0})}), method);
      EXPECT_LE(m.error.max_sampled, 1.5);
      EXPECT_LE(m.bound.max_bound, 2);  // No cosine is above 1; loose where the normal vanishes.
    }
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
    for (const BakeMethod method : every_method) measure(scene, method);
    EXPECT_TRUE(is_certified(measure(scene, BakeMethod::adaptive)));
  }
}

TEST(Interpolation, ASharedNormalAtACrease_LeansByHalfTheAngle_CopiesDoNot) {
  // A roof under a sun straight onto its left half. Both pictures use the shared normal, so that no
  // comparison of the two finds it.
  for (const double degrees : {1.0, 30.0, 60.0, 90.0, 120.0, 170.0}) {
    const double fold = degrees * pi / 180;
    Mesh mesh = two_triangles();
    mesh.positions[2] = {std::cos(fold), -std::sin(fold), 0};
    const std::vector<Light> lights = {sun({0, 1, 0})};
    EXPECT_NEAR(bake(scene_of(mesh, lights), {}).colors[0].r, std::cos(fold / 2), 1e-6) << degrees;
    EXPECT_EQ(split_creases(mesh, static_cast<float>(fold) * 1.01f), 0U);
    EXPECT_EQ(split_creases(mesh, static_cast<float>(fold) * 0.99f), 2U);
    const Scene scene = scene_of(mesh, lights);
    for (const BakeMethod method : every_method) {
      const Measured m = measure(scene, method);
      EXPECT_LT(m.error.max_sampled, 1e-6);
      const Mesh& out = mesh_of(scene, m.baked);
      for (std::size_t v = 0; v < out.n_vertices(); ++v)
        if (out.positions[v].x < 0 && out.positions[v].y == 0) {
          EXPECT_NEAR(m.baked.colors[v].r, 1, 1e-6) << degrees;
        }
    }
  }
}

TEST(Interpolation, ATextureSeam_ChangesNoColour_ForAnyMethod) {
  // The same sphere with and without a copy of each vertex on a cut through it; copies share their normal.
  const Mesh whole = icosphere(2);
  Mesh seamed = whole;
  std::vector<std::uint32_t> copies(whole.n_vertices(), 0);
  std::vector<bool> is_used(whole.n_vertices(), false);
  for (glm::uvec3& t : seamed.triangles) {
    const bool is_right = whole.positions[t.x].x + whole.positions[t.y].x + whole.positions[t.z].x > 0;
    for (int c = 0; c < 3; ++c) {
      if (is_right) {
        is_used[t[c]] = true;
        continue;
      }
      if (copies[t[c]] == 0) copies[t[c]] = append_vertex_copy(seamed, t[c]);
      t[c] = copies[t[c]];
    }
  }
  const std::vector<Light> lights = {sun({0.4f, 1, 0.3f}, 0.5f), lamp({1.5f, 2, -1}, 2)};
  const Scene a = scene_of(whole, lights), b = scene_of(seamed, lights);
  for (const BakeMethod method : every_method) {
    const Measured one = measure(a, method), other = measure(b, method);
    EXPECT_EQ(mesh_of(a, one.baked).n_triangles(), mesh_of(b, other.baked).n_triangles());
    EXPECT_NEAR(one.error.rmse, other.error.rmse, 1e-6 * one.error.rmse);
    if (method == BakeMethod::face) continue;  // Has no shared vertices.
    for (std::uint32_t v = 0; v < whole.n_vertices(); ++v) {
      if (is_used[v]) {
        EXPECT_NEAR(one.baked.colors[v].r, other.baked.colors[v].r, 1e-6);
      }
      if (copies[v] > 0) {
        EXPECT_NEAR(one.baked.colors[v].r, other.baked.colors[copies[v]].r, 1e-6);
      }
    }
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
