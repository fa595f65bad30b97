#include "lambake/render/shade.h"

#include <gtest/gtest.h>

#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/render/framing.h"
#include "meshes.h"

namespace lambake {
namespace {

using testing::pixel_camera;
using testing::scene_of;

/// The square [0,16]² at z = 0, normals +z, as two triangles: fills a picture of 16×16 pixels.
Scene square_scene() {
  Scene scene = scene_of({{0, 0, 0}, {16, 0, 0}, {16, 16, 0}, {0, 16, 0}}, {{0, 1, 2}, {0, 2, 3}});
  scene.mesh.normals.assign(4, {0, 0, 1});
  return scene;
}

Light sun(const glm::vec3& direction_to_light, const LinearRgb& intensity = {1, 1, 1}) {
  Light light;
  light.direction_to_light = glm::normalize(direction_to_light);
  light.intensity = intensity;
  return light;
}

Picture per_fragment(const Scene& scene) {
  return shade_per_fragment(scene, find_visibility(scene, scene.mesh, pixel_camera(16, 16), 16, 16));
}

Picture per_vertex(const Scene& scene) {
  return shade_per_vertex(scene, bake(scene, {}),
                          find_visibility(scene, scene.mesh, pixel_camera(16, 16), 16, 16));
}

TEST(ShadePerFragment, PlaneUnderALamp_IsTheClosedForm) {
  Scene scene = square_scene();
  Light lamp;
  lamp.type = LightType::point;
  lamp.position = {5, 7, 4};
  lamp.intensity = {30, 20, 10};
  scene.lights = {lamp};
  const Picture picture = per_fragment(scene);
  for (std::uint32_t y = 0; y < 16; ++y)
    for (std::uint32_t x = 0; x < 16; ++x) {
      const double dx = x + 0.5 - 5, dy = 16 - (y + 0.5) - 7;
      const double e = 4 / std::pow(dx * dx + dy * dy + 16, 1.5);  // cos θ / d²
      const LinearRgb& c = picture.pixels[y * 16 + x];
      ASSERT_NEAR(c.r, 30 * e, 3e-6 * 30 * e);
      ASSERT_NEAR(c.g, 20 * e, 3e-6 * 20 * e);
      ASSERT_NEAR(c.b, 10 * e, 3e-6 * 10 * e);
    }
}

TEST(ShadePerFragment, SmoothSphereUnderASun_IsTheCosineOfTheInterpolatedNormal) {
  Scene scene = scene_of({}, {});
  scene.mesh = testing::sphere_mesh(24);
  scene.lights = {sun({0.3f, 0.5f, 1})};
  const Camera camera = frame(scene.mesh.positions, 1);
  const Visibility seen = find_visibility(scene, scene.mesh, camera, 64, 64);
  const Picture picture = shade_per_fragment(scene, seen);
  std::size_t n_lit = 0;
  for (std::size_t i = 0; i < seen.triangles.size(); ++i) {
    if (seen.triangles[i] == no_triangle) {
      EXPECT_EQ(picture.pixels[i], background);
      continue;
    }
    const glm::uvec3& t = scene.mesh.triangles[seen.triangles[i]];
    const glm::dvec2 b(seen.barycentrics[i]);
    const auto& n = scene.mesh.normals;
    const glm::dvec3 normal = glm::normalize((1 - b.x - b.y) * glm::dvec3(n[t[0]]) +
                                             b.x * glm::dvec3(n[t[1]]) + b.y * glm::dvec3(n[t[2]]));
    const double expected = std::max(0.0, glm::dot(normal, glm::dvec3(scene.lights[0].direction_to_light)));
    ASSERT_NEAR(picture.pixels[i].g, expected, 1e-6);
    n_lit += expected > 0.1;
  }
  EXPECT_GT(n_lit, 300u);
}

TEST(Shade, FlatFaceUnderSuns_BothShadingsAreEqualToTheBit) {
  Scene scene = square_scene();
  const glm::vec3 normal = glm::normalize(glm::vec3(0.37f, -0.2f, 0.9f));
  scene.mesh.normals.assign(4, normal);
  scene.mesh.colors.assign(4, {0.3f, 0.7f, 0.11f});
  scene.materials[0].base_color = {0.9f, 0.37f, 0.21f};
  scene.materials[0].emission = {0.013f, 0.2f, 0};
  scene.lights = {sun({0.4f, 1, 0.3f}, {1, 0.9f, 0.7f}), sun({-0.3f, 0.2f, 1}, {0.2f, 0.3f, 0.77f})};
  const Picture fragment = per_fragment(scene), vertex = per_vertex(scene);
  EXPECT_EQ(fragment.pixels, vertex.pixels);
  EXPECT_GT(fragment.pixels[0].g, 0.2f);
}

TEST(ShadePerVertex, ColoursOfTheCorners_AreInterpolated) {
  Scene scene = square_scene();
  BakedColors baked;
  for (const glm::vec3& p : scene.mesh.positions) baked.colors.push_back({p.x, p.y, 1 + p.x + 2 * p.y});
  const Picture picture =
      shade_per_vertex(scene, baked, find_visibility(scene, scene.mesh, pixel_camera(16, 16), 16, 16));
  for (std::uint32_t y = 0; y < 16; ++y)
    for (std::uint32_t x = 0; x < 16; ++x) {
      const double px = x + 0.5, py = 16 - (y + 0.5);
      const LinearRgb& c = picture.pixels[y * 16 + x];
      ASSERT_NEAR(c.r, px, 1e-5);
      ASSERT_NEAR(c.g, py, 1e-5);
      ASSERT_NEAR(c.b, 1 + px + 2 * py, 1e-5);
    }
}

TEST(Shade, TextureAndEmission_AreSampledPerPixelInBoth) {
  Scene scene = square_scene();
  scene.mesh.texcoords[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  scene.images.push_back({2, 1, {{1, 0, 0, 1}, {0, 0.5f, 0, 1}}});
  scene.textures.emplace_back();
  scene.textures[0].filter = TextureFilter::nearest;
  scene.materials[0].base_color_texture = 0;
  scene.materials[0].base_color = {0.5f, 0.5f, 0.5f};
  scene.materials[0].emission_texture = 0;
  scene.materials[0].emission = {0, 3, 0};
  scene.lights = {sun({0, 0, 1})};
  for (const Picture& picture : {per_fragment(scene), per_vertex(scene)})
    for (std::size_t i = 0; i < picture.n_pixels(); ++i)
      ASSERT_EQ(picture.pixels[i], (i % 16 < 8 ? LinearRgb{0.5f, 0, 0} : LinearRgb{0, 1.75f, 0})) << i;
}

TEST(Shade, UnlitMaterial_ShowsItsBaseColourInBoth) {
  Scene scene = square_scene();
  scene.materials[0].is_unlit = true;
  scene.materials[0].base_color = {0.25f, 0.5f, 1};
  scene.materials[0].emission = {1, 1, 1};
  scene.mesh.colors.assign(4, {1, 0.5f, 0.5f});
  scene.lights = {sun({0, 1, 1})};
  for (const Picture& picture : {per_fragment(scene), per_vertex(scene)})
    for (const LinearRgb& c : picture.pixels) ASSERT_EQ(c, (LinearRgb{0.25f, 0.25f, 0.5f}));
}

TEST(ShadePerFragment, NormalsThatCancel_GiveNoLightAndNoNaN) {
  Scene scene = square_scene();
  scene.mesh.normals = {{0, 0, 1}, {0, 0, -1}, {0, 0, 0}, {0, 0, 0}};
  scene.lights = {sun({0, 0, 1})};
  for (const LinearRgb& c : per_fragment(scene).pixels) ASSERT_TRUE(is_finite(c));
  scene.mesh.normals.assign(4, {0, 0, 0});
  for (const LinearRgb& c : per_fragment(scene).pixels) ASSERT_EQ(c, (LinearRgb{0, 0, 0}));
}

TEST(ShadePerFragment, SceneWithoutNormals_Throws) {
  Scene scene = square_scene();
  scene.mesh.normals.clear();
  EXPECT_THROW(per_fragment(scene), InvalidScene);
}

TEST(Shade, OneThreadAndTwo_GiveTheSamePictures) {
  Scene scene = scene_of({}, {});
  scene.mesh = testing::sphere_mesh(40);
  scene.lights = {sun({0.3f, 0.5f, 1})};
  const Visibility seen = find_visibility(scene, scene.mesh, frame(scene.mesh.positions, 1), 200, 200);
  const BakedColors baked = bake(scene, {});
  set_thread_count(1);
  const Picture fragment = shade_per_fragment(scene, seen), vertex = shade_per_vertex(scene, baked, seen);
  set_thread_count(2);
  EXPECT_EQ(shade_per_fragment(scene, seen).pixels, fragment.pixels);
  EXPECT_EQ(shade_per_vertex(scene, baked, seen).pixels, vertex.pixels);
  set_thread_count(0);
}

/// The picture's memory comes used, and neither side is a whole number of tiles or groups of pixels.
TEST(Render, TileByTileOnAnyNumberOfThreads_IsThePictureOfTheWholeVisibility) {
  Scene scene = scene_of({}, {});
  scene.mesh = testing::sphere_mesh(40);
  scene.lights = {sun({0.3f, 0.5f, 1})};
  scene.materials[0].emission = {0, 0.25f, 0};
  const BakedColors baked = bake(scene, {});
  Camera camera = frame(scene.mesh.positions, 1);
  camera.vertical_fov_rad *= 2;  // tiles without anything around
  for (const auto& [width, height] : {std::pair{333u, 201u}, std::pair{64u, 64u}, std::pair{5u, 130u}}) {
    SCOPED_TRACE(::testing::Message() << width << "x" << height);
    const Visibility seen = find_visibility(scene, scene.mesh, camera, width, height);
    ASSERT_GT(seen.n_covered, 0u);
    for (const std::size_t n_threads : {1u, 2u}) {
      set_thread_count(n_threads);
      Picture picture;
      picture.pixels.assign(7, {9, 9, 9});
      EXPECT_EQ(render_per_fragment(scene, camera, width, height, picture), seen.n_covered);
      EXPECT_EQ(picture.width, width);
      EXPECT_EQ(picture.height, height);
      EXPECT_EQ(picture.pixels, shade_per_fragment(scene, seen).pixels);
      std::fill(picture.pixels.begin(), picture.pixels.end(), LinearRgb{9, 9, 9});
      EXPECT_EQ(render_per_vertex(scene, baked, camera, width, height, picture), seen.n_covered);
      EXPECT_EQ(picture.pixels, shade_per_vertex(scene, baked, seen).pixels);
    }
    set_thread_count(0);
  }
}

TEST(CountSeenFromBehind, FacesTurnedFromTheirNormals_AreCountedByPixel) {
  Scene scene = square_scene();
  const Camera camera = pixel_camera(16, 16);
  const auto count = [&] {
    return count_seen_from_behind(scene, find_visibility(scene, scene.mesh, camera, 16, 16), camera);
  };
  EXPECT_EQ(count(), 0u);
  scene.mesh.normals.assign(4, {0, 0, -1});
  EXPECT_EQ(count(), 256u);
  for (glm::uvec3& t : scene.mesh.triangles) std::swap(t.y, t.z);  // winding does not matter
  EXPECT_EQ(count(), 256u);
  scene.mesh.normals.assign(4, {0, 0, 1});
  EXPECT_EQ(count(), 0u);
}

}  // namespace
}  // namespace lambake
