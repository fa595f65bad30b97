/// Where the mesh and the camera stand: scales, offsets, near planes. What is promised of them, for every
/// method and measure.
#include <algorithm>

#include "cases.h"
#include "lambake/render/framing.h"
#include "lambake/render/shade.h"

namespace lambake {
namespace {

/// Light at the vertices of `mesh`, by `sample`.
std::vector<LinearRgb> lit(Mesh mesh, std::vector<Light> lights) {
  return bake(scene_of(std::move(mesh), std::move(lights)), {}).colors;
}

TEST(Placement, AMillionExtentsFromTheOrigin_SameBitsWhileFloatHoldsThePositions) {
  // The grid's coordinates are multiples of 1/8, which float holds up to 2^20: about a million extents.
  const Mesh near = grid(16, 1);
  const std::vector<LinearRgb> expected = lit(near, {lamp({0.25f, 1, 0.5f})});
  for (const int exponent : {4, 10, 16, 20}) {
    const glm::vec3 offset(std::ldexp(1.0f, exponent), -std::ldexp(1.0f, exponent),
                           std::ldexp(1.0f, exponent));
    Mesh far = near;
    for (glm::vec3& p : far.positions) p += offset;
    EXPECT_EQ(lit(far, {lamp(glm::vec3(0.25f, 1, 0.5f) + offset)}), expected) << exponent;
  }
}

TEST(Placement, Scales_TenToThePlusMinusTwelve_SameBits) {
  // Twice the size and 2^k times the light is the same picture; powers of two are exact in float.
  const Mesh unit = height_field(8);
  for (const float k : {0.0f, 1.0f, 2.0f})
    for (const int exponent : {-40, -20, 20, 40}) {
      const float scale = std::ldexp(1.0f, exponent);
      Mesh scaled = unit;
      for (glm::vec3& p : scaled.positions) p *= scale;
      const float intensity = std::ldexp(1.0f, exponent * static_cast<int>(k));
      EXPECT_EQ(lit(scaled, {lamp(glm::vec3(0.5f, 1, 0.2f) * scale, intensity, k)}),
                lit(unit, {lamp({0.5f, 1, 0.2f}, 1, k)}))
          << k << " 2^" << exponent;
      for (const BakeMethod method : {BakeMethod::face, BakeMethod::sample})
        measure(scene_of(scaled, {lamp(glm::vec3(0.5f, 1, 0.2f) * scale, intensity, k)}), method);
    }
}

TEST(Cameras, InsideTheMesh_WithTheNearPlaneThroughIt_SeeBothWaysAlike) {
  const Scene scene = scene_of(icosphere(2), {sun({0.4f, 1, 0.3f}, 0.5f), lamp({1.5f, 2, -1}, 2)});
  for (const float distance : {0.0f, 0.5f, 0.99f, 1.0f, 1.01f}) {
    Camera camera = look_at({0, 0, distance}, {0, 0, distance - 1}, 1.2f);
    camera.near_distance = 0.01f;
    const Visibility visibility = find_visibility(scene, scene.mesh, camera, 64, 64);
    EXPECT_GT(visibility.n_covered, 0U);
    for (std::size_t i = 0; i < visibility.triangles.size(); ++i)
      EXPECT_TRUE(visibility.triangles[i] == no_triangle || visibility.depths[i] >= 0.01f * (1 - 1e-6f));
    for (const LinearRgb& c : shade_per_fragment(scene, visibility).pixels) EXPECT_TRUE(is_finite(c));
    for (const BakeMethod method : every_method) {
      // Whatever the method cuts, it covers the same pixels: the surface is the same.
      const BakedColors baked = bake(scene, {.method = method});
      const Visibility of_baked = find_visibility(scene, mesh_of(scene, baked), camera, 64, 64);
      EXPECT_EQ(of_baked.n_covered, visibility.n_covered) << static_cast<int>(method);
      for (const LinearRgb& c : shade_per_vertex(scene, baked, of_baked).pixels) EXPECT_TRUE(is_finite(c));
    }
    // From inside a closed mesh every pixel is covered.
    EXPECT_TRUE(distance > 0.9f || visibility.n_covered == 64U * 64U);
  }
}

/// Both pictures of what `method` makes of the scene, 64×64.
struct Pictures {
  Picture per_vertex, per_fragment;
  Visibility visibility;
};

Pictures take(const Scene& scene, const BakedColors& baked, const Camera& camera) {
  Pictures p;
  p.visibility = find_visibility(scene, scene.mesh, camera, 64, 64);
  p.per_fragment = shade_per_fragment(scene, p.visibility);
  p.per_vertex =
      shade_per_vertex(scene, baked, find_visibility(scene, mesh_of(scene, baked), camera, 64, 64));
  return p;
}

TEST(Placement, Scales_TenToThePlusMinusTwelve_EachMethodMeasureAndPictureIsTheSame) {
  const Scene unit = scene_of(height_field(8), {sun({1, 0.3f, 0.2f}, 0.5f), lamp({0.5f, 1, 0.2f}, 0.5f, 1)});
  for (const int exponent : {-40, -20, 20, 40}) {
    const float scale = std::ldexp(1.0f, exponent);
    Scene scaled = unit;
    for (glm::vec3& p : scaled.mesh.positions) p *= scale;
    scaled.lights[1].position *= scale;
    scaled.lights[1].intensity = scaled.lights[1].intensity * scale;
    for (const BakeMethod method : every_method) {
      SCOPED_TRACE(testing::Message() << "method " << static_cast<int>(method) << " 2^" << exponent);
      const Measured one = measure(unit, method), other = measure(scaled, method);
      EXPECT_NEAR(other.error.area, one.error.area * std::ldexp(1.0, 2 * exponent), 1e-9 * other.error.area);
      EXPECT_NEAR(other.bound.max_bound, one.bound.max_bound, 1e-9);
      if (method == BakeMethod::adaptive) {
        EXPECT_TRUE(is_certified(one) && is_certified(other));
        continue;
      }
      EXPECT_EQ(one.baked.colors, other.baked.colors);
      EXPECT_NEAR(other.error.rmse, one.error.rmse, 1e-9 * one.error.rmse);
      EXPECT_NEAR(other.error.max_sampled, one.error.max_sampled, 1e-9);
      const Pictures a = take(unit, one.baked, frame(unit.mesh.positions, 1)),
                     b = take(scaled, other.baked, frame(scaled.mesh.positions, 1));
      EXPECT_EQ(a.visibility.triangles, b.visibility.triangles);
      EXPECT_EQ(a.per_vertex.pixels, b.per_vertex.pixels);
      EXPECT_EQ(a.per_fragment.pixels, b.per_fragment.pixels);
    }
  }
}

TEST(Placement, AMillionExtentsFromTheOrigin_EachMethodMeasureAndPicture_WithinTheStepsOfFloat) {
  const std::vector<Light> lights = {sun({1, 0.3f, 0.2f}, 0.5f), lamp({0.25f, 1, 0.5f}, 0.5f)};
  const Scene near = scene_of(grid(4, 1), lights);
  for (const int exponent : {10, 16, 20}) {
    const glm::vec3 offset(std::ldexp(1.0f, exponent), -std::ldexp(1.0f, exponent),
                           std::ldexp(1.0f, exponent));
    Scene far = near;
    for (glm::vec3& p : far.mesh.positions) p += offset;
    far.lights[1].position += offset;
    // What lies between vertices (centroids, cuts) is rounded to steps of 2^(exponent − 23).
    const double step = std::ldexp(1.0, exponent - 23);
    for (const BakeMethod method : every_method) {
      SCOPED_TRACE(testing::Message() << "method " << static_cast<int>(method) << " 2^" << exponent);
      const Measured one = measure(near, method), other = measure(far, method);
      EXPECT_NEAR(other.error.rmse, one.error.rmse, 1e-3 * one.error.rmse + step);
      EXPECT_NEAR(other.error.area, one.error.area, 1e-9);
      const Camera camera = look_at({0, 3, 4}, {0, 0, 0}, 0.6f);
      const Camera moved = look_at(glm::vec3(0, 3, 4) + offset, offset, 0.6f);
      const Pictures a = take(near, one.baked, camera), b = take(far, other.baked, moved);
      // Adaptive reckons with the steps, and so cuts elsewhere.
      const bool is_adaptive = method == BakeMethod::adaptive;
      const double most = is_adaptive ? other.baked.certificate->max_bound : 0;
      if (!is_adaptive) {
        EXPECT_EQ(a.visibility.triangles, b.visibility.triangles);
      }
      for (std::size_t i = 0; i < a.per_vertex.pixels.size(); ++i) {
        EXPECT_NEAR(a.per_fragment.pixels[i].r, b.per_fragment.pixels[i].r, 1e-4);
        if (is_adaptive) {
          EXPECT_NEAR(compared(b.per_vertex.pixels[i].r, ErrorSpace::display),
                      compared(b.per_fragment.pixels[i].r, ErrorSpace::display), most + 1e-4);
        } else {
          EXPECT_NEAR(a.per_vertex.pixels[i].r, b.per_vertex.pixels[i].r, 1e-4 + step);
        }
      }
    }
  }
}

}  // namespace
}  // namespace lambake
