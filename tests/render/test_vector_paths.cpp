#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "lambake/render/framing.h"
#include "lambake/render/pixel_hits.h"
#include "lambake/render/shade.h"
#include "lambake/render/visibility.h"
#include "meshes.h"

namespace lambake {
namespace {

constexpr std::uint32_t width = 150, height = 90;  // neither is a whole number of tiles or vectors

/// A sphere of many small and, at its poles, thin triangles, with an unlit square through it that the near
/// plane cuts.
Scene mixed_scene() {
  Scene scene = testing::scene_of({}, {});
  scene.mesh = testing::sphere_mesh(60);
  const std::uint32_t n = static_cast<std::uint32_t>(scene.mesh.n_vertices());
  for (const glm::vec3& p :
       {glm::vec3(-9, -0.3f, -9), glm::vec3(-9, -0.2f, 9), glm::vec3(9, -0.3f, 9), glm::vec3(9, -0.2f, -9)}) {
    scene.mesh.positions.push_back(p);
    scene.mesh.normals.emplace_back(0, 1, 0);
  }
  scene.mesh.triangles.insert(scene.mesh.triangles.end(), {{n, n + 1, n + 2}, {n, n + 2, n + 3}});
  Light lamp;
  lamp.type = LightType::point;
  lamp.position = {2, 3, 1};
  lamp.intensity = {9, 8, 7};
  scene.lights = {Light{}, lamp};
  return scene;
}

const Camera camera = look_at({0.5f, 0.8f, 3}, {0, 0, 0}, 0.9f);

/// Only the given vector path from here on; 0 brings back all.
void use_path(std::int64_t target) {
  hwy::SetSupportedTargetsForTest(target);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

TEST(VectorPaths, OfThisMachine_GiveTheSamePicturesToTheBit) {
  const Scene scene = mixed_scene();
  const Visibility seen = find_visibility(scene, scene.mesh, camera, width, height);
  const Picture fragment = shade_per_fragment(scene, seen);
  const BakedColors baked = bake(scene, {});
  const Picture vertex = shade_per_vertex(scene, baked, seen);
  EXPECT_GT(seen.n_covered, 3000u);

  const std::int64_t all = hwy::SupportedTargets();
  int n_paths = 0;
  for (std::int64_t target = 1; target != 0 && target <= all; target <<= 1) {
    if ((all & target) == 0) continue;
    use_path(target);
    ++n_paths;
    const Visibility again = find_visibility(scene, scene.mesh, camera, width, height);
    EXPECT_EQ(again.triangles, seen.triangles) << hwy::TargetName(target);
    EXPECT_EQ(again.barycentrics, seen.barycentrics) << hwy::TargetName(target);
    EXPECT_EQ(again.depths, seen.depths) << hwy::TargetName(target);
    EXPECT_EQ(shade_per_fragment(scene, seen).pixels, fragment.pixels) << hwy::TargetName(target);
    EXPECT_EQ(shade_per_vertex(scene, baked, seen).pixels, vertex.pixels) << hwy::TargetName(target);
  }
  use_path(0);
  EXPECT_GT(n_paths, 0);
}

TEST(PixelHits, OfARow_AreThoseOfEachRayToTheBit) {
  const Scene scene = mixed_scene();
  const Visibility seen = find_visibility(scene, scene.mesh, camera, width, height);
  const ViewTransform view(camera, width, height);
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::size_t i = std::size_t{y} * width + x;
      if (seen.triangles[i] == no_triangle) continue;
      const glm::uvec3& t = scene.mesh.triangles[seen.triangles[i]];
      const auto& p = scene.mesh.positions;
      const RayHit hit = hit_triangle(view.pixel_ray(x, y), p[t[0]], p[t[1]], p[t[2]]);
      ASSERT_EQ(seen.barycentrics[i], glm::vec2(hit.barycentrics)) << x << ", " << y;
      ASSERT_EQ(seen.depths[i], static_cast<float>(hit.depth)) << x << ", " << y;
    }
}

TEST(Visibility, MaskThatIsOpaqueEverywhere_ChangesNothing) {
  Scene scene = mixed_scene();
  const Visibility plain = find_visibility(scene, scene.mesh, camera, width, height);
  scene.materials[0].alpha_mode = AlphaMode::mask;
  const Visibility tested = find_visibility(scene, scene.mesh, camera, width, height);
  EXPECT_EQ(tested.triangles, plain.triangles);
  EXPECT_EQ(tested.barycentrics, plain.barycentrics);
  EXPECT_EQ(tested.depths, plain.depths);
}

}  // namespace
}  // namespace lambake
