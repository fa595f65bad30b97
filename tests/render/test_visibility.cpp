#include "lambake/render/visibility.h"

#include <gtest/gtest.h>

#include <limits>

#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/render/framing.h"
#include "meshes.h"

namespace lambake {
namespace {

using testing::grid_mesh;
using testing::pixel_camera;
using testing::scene_of;

/// How many triangles of the mesh, each drawn alone, cover each pixel.
std::vector<int> coverage_counts(const Scene& scene, const Camera& camera, std::uint32_t width,
                                 std::uint32_t height) {
  std::vector<int> counts(std::size_t{width} * height);
  Mesh alone = scene.mesh;
  for (const glm::uvec3& t : scene.mesh.triangles) {
    alone.triangles = {t};
    const Visibility seen = find_visibility(scene, alone, camera, width, height);
    for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += seen.triangles[i] != no_triangle;
  }
  return counts;
}

void expect_each_pixel_once(const Scene& scene, const Camera& camera, std::uint32_t width,
                            std::uint32_t height) {
  const std::vector<int> counts = coverage_counts(scene, camera, width, height);
  for (std::size_t i = 0; i < counts.size(); ++i)
    ASSERT_EQ(counts[i], 1) << "pixel " << i % width << ", " << i / width;
}

TEST(Visibility, JitteredGridsOfAnyDensity_CoverEachPixelExactlyOnce) {
  const std::uint32_t width = 37, height = 29;
  for (const std::uint32_t cells : {1u, 2u, 5u, 17u}) {
    Scene scene = scene_of({}, {});
    scene.mesh = grid_mesh(cells, cells, cells);
    std::mt19937 random(cells);
    std::uniform_real_distribution<float> jitter(-0.2f / float(cells), 0.2f / float(cells));
    for (glm::vec3& p : scene.mesh.positions) {
      const bool is_inner = p.x > 0 && p.x < 1 && p.y > 0 && p.y < 1;
      if (is_inner) p += glm::vec3(jitter(random), jitter(random), 0);
      p = p * glm::vec3(45, 35, 1) - glm::vec3(4, 3, 0);
    }
    expect_each_pixel_once(scene, pixel_camera(width, height), width, height);
  }
}

TEST(Visibility, VerticesAndEdgesOnPixelCentres_CoverEachPixelExactlyOnce) {
  Scene scene = scene_of({}, {});
  scene.mesh = grid_mesh(12, 12, 3);
  for (glm::vec3& p : scene.mesh.positions) p = p * 24.0f - glm::vec3(2.5f, 2.5f, 0);  // every other centre
  expect_each_pixel_once(scene, pixel_camera(16, 16), 16, 16);
}

TEST(Visibility, FanAroundAPixelCentre_CoversEachPixelExactlyOnce) {
  Scene scene = scene_of({{8.5f, 8.5f, 0}}, {});
  const std::uint32_t n = 61;
  for (std::uint32_t i = 0; i < n; ++i) {
    const float angle = 6.28318531f * float(i) / float(n);
    scene.mesh.positions.emplace_back(8.5f + 40 * std::cos(angle), 8.5f + 40 * std::sin(angle), 0.0f);
    scene.mesh.triangles.emplace_back(0u, 1 + i, 1 + (i + 1) % n);
  }
  expect_each_pixel_once(scene, pixel_camera(16, 16), 16, 16);
}

TEST(Visibility, TrianglesFarBeyondTheGuardBand_CoverEachPixelExactlyOnce) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> inside(2, 14);
  for (int trial = 0; trial < 50; ++trial) {
    Scene scene = scene_of({{inside(random), inside(random), 0}}, {});
    const std::uint32_t n = 5;
    for (std::uint32_t i = 0; i < n; ++i) {
      const float angle = 6.28318531f * float(i) / float(n) + 0.1f * float(trial);
      scene.mesh.positions.emplace_back(1e7f * std::cos(angle), 3e6f * std::sin(angle), 0.0f);
      scene.mesh.triangles.emplace_back(0u, 1 + i, 1 + (i + 1) % n);
    }
    expect_each_pixel_once(scene, pixel_camera(16, 16), 16, 16);
  }
}

TEST(Visibility, TrianglesSmallerThanAPixel_CoverEachPixelExactlyOnce) {
  Scene scene = scene_of({}, {});
  scene.mesh = grid_mesh(80, 80, 7);
  for (glm::vec3& p : scene.mesh.positions) p = p * 5.0f - glm::vec3(0.3f, 0.2f, 0);
  expect_each_pixel_once(scene, pixel_camera(4, 4), 4, 4);
}

TEST(Visibility, TiltedPlane_InterpolatedRampMatchesTheRayHit) {
  const Scene scene = scene_of({{-3, -2, -2}, {4, -2.5f, -9}, {0.5f, 3, -4}}, {{0, 1, 2}});
  Camera camera;
  camera.vertical_fov_rad = 1.0f;
  const std::uint32_t width = 160, height = 100;
  const Visibility seen = find_visibility(scene, scene.mesh, camera, width, height);
  ASSERT_GT(seen.n_covered, 1000u);
  const auto& p = scene.mesh.positions;
  const glm::dvec3 p0(p[0]), normal = glm::cross(glm::dvec3(p[1]) - p0, glm::dvec3(p[2]) - p0);
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::size_t i = y * width + x;
      if (seen.triangles[i] == no_triangle) continue;
      const double t = std::tan(0.5 * double(camera.vertical_fov_rad)) / (0.5 * height);
      const glm::dvec3 ray((x + 0.5 - 0.5 * width) * t, (0.5 * height - y - 0.5) * t, -1);
      const glm::dvec3 hit = ray * (glm::dot(p0, normal) / glm::dot(ray, normal));
      const glm::dvec2 b(seen.barycentrics[i]);
      const glm::dvec3 interpolated = p0 + b.x * (glm::dvec3(p[1]) - p0) + b.y * (glm::dvec3(p[2]) - p0);
      // Weights are floats (2^-24), edges up to 10 long. At the outline the pixel's centre may lie outside by
      // the subpixel grid: 1/512 of a pixel, there t·depth wide.
      const bool is_inside = b.x > 0 && b.y > 0 && b.x + b.y < 0.9999999;
      ASSERT_LT(glm::length(interpolated - hit), is_inside ? 2e-6 : 1e-3) << x << ", " << y;
      if (is_inside) {
        EXPECT_NEAR(seen.depths[i], -hit.z, 1e-6 * -hit.z);
      }
    }
}

TEST(Visibility, GroundPlaneThroughTheEye_IsSeenUpToTheHorizon) {
  // y = −1 from far behind the camera to far in front; the near plane cuts it.
  const Scene scene = scene_of({{-4000, -1, 4000}, {4000, -1, 4000}, {4000, -1, -4000}, {-4000, -1, -4000}},
                               {{0, 1, 2}, {0, 2, 3}});
  Camera camera;
  camera.vertical_fov_rad = 1.4f;
  camera.near_distance = 0.5f;
  const std::uint32_t width = 64, height = 64;
  const Visibility seen = find_visibility(scene, scene.mesh, camera, width, height);
  const double t = std::tan(0.7) / 32;
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const double down = (y + 0.5 - 32) * t;  // per unit of depth
      const double depth = 1 / down;
      const bool is_seen = down > 0 && depth > 0.5 && depth < 4000;
      const std::size_t i = y * width + x;
      ASSERT_EQ(seen.triangles[i] != no_triangle, is_seen) << x << ", " << y;
      if (is_seen) {
        EXPECT_NEAR(seen.depths[i], depth, 1e-6 * depth);
      }
    }
}

TEST(Visibility, PlaneCutByTheNearPlane_BothTrianglesCoverEachPixelOnce) {
  Scene scene = scene_of({{-50, -1, 1}, {50, -1, 1}, {50, -1, -500}, {-50, -1, -500}, {0.3f, -1, -0.2f}},
                         {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
  Camera camera;
  camera.vertical_fov_rad = 1.2f;
  camera.near_distance = 0.4f;
  const std::uint32_t side = 48;
  const Visibility all = find_visibility(scene, scene.mesh, camera, side, side);
  const std::vector<int> counts = coverage_counts(scene, camera, side, side);
  ASSERT_GT(all.n_covered, 500u);
  for (std::size_t i = 0; i < counts.size(); ++i)
    ASSERT_EQ(counts[i], all.triangles[i] != no_triangle) << i % side << ", " << i / side;
}

TEST(Visibility, FarPlane_CutsWhatLiesBehind) {
  const Scene scene = scene_of({{-4000, -1, -1}, {4000, -1, -1}, {0, -1, -4000}}, {{0, 1, 2}});
  Camera camera;
  camera.vertical_fov_rad = 1.4f;
  camera.far_distance = 10;
  const Visibility seen = find_visibility(scene, scene.mesh, camera, 64, 64);
  ASSERT_GT(seen.n_covered, 0u);
  const double t = std::tan(0.7) / 32;
  for (std::uint32_t y = 0; y < 64; ++y) {
    const double depth = 1 / ((y + 0.5 - 32) * t);
    ASSERT_EQ(seen.triangles[y * 64 + 32] != no_triangle, depth > 1 && depth < 10) << y;
  }
}

TEST(Visibility, OverlappingTriangles_TheNearerIsSeen_TiesGoToTheLowerIndex) {
  Scene scene = scene_of({{-9, -9, 0}, {30, -9, 0}, {-9, 30, 0}, {-9, -9, 1}, {30, -9, 1}, {-9, 30, 1}},
                         {{0, 1, 2}, {3, 4, 5}, {4, 5, 3}, {5, 4, 3}});
  const Visibility seen = find_visibility(scene, scene.mesh, pixel_camera(8, 8), 8, 8);
  EXPECT_EQ(seen.n_covered, 64u);
  for (const std::uint32_t t : seen.triangles) EXPECT_EQ(t, 1u);
  for (const float d : seen.depths) EXPECT_FLOAT_EQ(d, 9.0f);
}

TEST(Visibility, RepeatedFacesInAnyOrderOfCorners_TheFirstIsSeen) {
  for (const std::uint32_t rings : {6u, 150u}) {  // large triangles, and ones of a few pixels
    Scene scene = scene_of({}, {});
    scene.mesh = testing::sphere_mesh(rings);
    const Camera camera = frame(scene.mesh.positions, 1);
    const Visibility alone = find_visibility(scene, scene.mesh, camera, 100, 100);
    const std::vector<glm::uvec3> once = scene.mesh.triangles;
    for (const glm::uvec3& t : once) scene.mesh.triangles.emplace_back(t[1], t[2], t[0]);
    for (const glm::uvec3& t : once) scene.mesh.triangles.emplace_back(t[2], t[0], t[1]);
    for (const glm::uvec3& t : once) scene.mesh.triangles.emplace_back(t[0], t[2], t[1]);
    EXPECT_EQ(find_visibility(scene, scene.mesh, camera, 100, 100).triangles, alone.triangles);
  }
}

TEST(Visibility, SingleSidedMaterial_IsNotSeenFromBehind) {
  Scene scene = scene_of({{-9, -9, 0}, {30, -9, 0}, {-9, 30, 0}}, {{0, 1, 2}});
  scene.materials[0].is_double_sided = false;
  EXPECT_EQ(find_visibility(scene, scene.mesh, pixel_camera(8, 8), 8, 8).n_covered, 64u);
  std::swap(scene.mesh.triangles[0].y, scene.mesh.triangles[0].z);
  EXPECT_EQ(find_visibility(scene, scene.mesh, pixel_camera(8, 8), 8, 8).n_covered, 0u);
  scene.materials[0].is_double_sided = true;
  EXPECT_EQ(find_visibility(scene, scene.mesh, pixel_camera(8, 8), 8, 8).n_covered, 64u);
}

TEST(Visibility, MaskedTexture_ShowsWhatIsBehindItsHoles) {
  // A square of 8×8 pixels before a bigger one; the left half of its texture is transparent.
  Scene scene = scene_of({{0, 0, 1}, {8, 0, 1}, {8, 8, 1}, {0, 8, 1}, {-9, -9, 0}, {30, -9, 0}, {-9, 30, 0}},
                         {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}});
  scene.mesh.texcoords[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}};
  scene.images.push_back({2, 1, {{1, 1, 1, 0}, {1, 1, 1, 1}}});
  scene.textures.emplace_back();
  scene.textures[0].filter = TextureFilter::nearest;
  scene.materials[0].alpha_mode = AlphaMode::mask;
  scene.materials[0].base_color_texture = 0;
  scene.materials.emplace_back();
  scene.mesh.materials = {0, 0, 1};
  const Visibility seen = find_visibility(scene, scene.mesh, pixel_camera(8, 8), 8, 8);
  for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(seen.triangles[i] == 2, i % 8 < 4) << i;

  scene.materials[0].opacity = 0.4f;  // below the cutoff of 0.5 everywhere
  for (const std::uint32_t t : find_visibility(scene, scene.mesh, pixel_camera(8, 8), 8, 8).triangles)
    EXPECT_EQ(t, 2u);
}

TEST(Visibility, VertexThatIsNotFinite_TakesItsTrianglesAlongAndNoOther) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  Scene scene = scene_of({{-9, -9, 0}, {30, -9, 0}, {-9, 30, 0}, {nan, 0, 5}, {0, inf, 5}},
                         {{0, 1, 3}, {0, 4, 2}, {0, 1, 2}});
  const Visibility seen = find_visibility(scene, scene.mesh, pixel_camera(8, 8), 8, 8);
  for (const std::uint32_t t : seen.triangles) EXPECT_EQ(t, 2u);
}

TEST(Visibility, HugeAndTinyScales_SeeTheSame) {
  for (const float scale : {1e-12f, 1.0f, 1e12f}) {
    Scene scene = scene_of({}, {});
    scene.mesh = testing::sphere_mesh(64);
    for (glm::vec3& p : scene.mesh.positions) p *= scale;
    const Camera camera = frame(scene.mesh.positions, 1.0f);
    const Visibility seen = find_visibility(scene, scene.mesh, camera, 64, 64);
    // The sphere fills the picture but for a margin of 2 %: its outline has the radius
    // tan(asin(sin(0.3) / 1.02)) / tan(0.3) of half the picture.
    const double radius = std::tan(std::asin(std::sin(0.3) / 1.02)) / std::tan(0.3);
    EXPECT_NEAR(double(seen.n_covered) / (64 * 64), 0.25 * 3.14159265 * radius * radius, 0.004) << scale;
  }
}

TEST(Visibility, NoTrianglesOrOnlyDegenerateOnes_CoverNothing) {
  Scene scene = scene_of({{1, 1, 0}, {5, 5, 0}, {7, 7, 0}}, {});
  EXPECT_EQ(find_visibility(scene, scene.mesh, pixel_camera(8, 8), 8, 8).n_covered, 0u);
  scene.mesh.triangles = {{0, 1, 2}, {0, 0, 1}, {2, 2, 2}};
  const Visibility seen = find_visibility(scene, scene.mesh, pixel_camera(8, 8), 8, 8);
  EXPECT_EQ(seen.n_covered, 0u);
  for (const float d : seen.depths) EXPECT_EQ(d, std::numeric_limits<float>::infinity());
}

TEST(Visibility, SizesAndCamerasOutOfRange_Throw) {
  const Scene scene = scene_of({}, {});
  EXPECT_THROW(find_visibility(scene, scene.mesh, Camera{}, 0, 8), InvalidOption);
  EXPECT_THROW(find_visibility(scene, scene.mesh, Camera{}, 8, 20000), InvalidOption);
  Camera camera;
  camera.near_distance = 0;
  EXPECT_THROW(find_visibility(scene, scene.mesh, camera, 8, 8), InvalidOption);
  camera = {};
  camera.vertical_fov_rad = 3.2f;
  EXPECT_THROW(find_visibility(scene, scene.mesh, camera, 8, 8), InvalidOption);
  camera = {};
  camera.world_from_camera[0] = glm::vec4(0);
  EXPECT_THROW(find_visibility(scene, scene.mesh, camera, 8, 8), InvalidOption);
}

TEST(Visibility, OneThreadAndTwo_SeeTheSame) {
  Scene scene = scene_of({}, {});
  scene.mesh = testing::sphere_mesh(200);  // more triangles than a block
  const Camera camera = frame(scene.mesh.positions, 1.5f);
  set_thread_count(1);
  const Visibility one = find_visibility(scene, scene.mesh, camera, 300, 200);
  set_thread_count(2);
  const Visibility two = find_visibility(scene, scene.mesh, camera, 300, 200);
  set_thread_count(0);
  EXPECT_EQ(one.triangles, two.triangles);
  EXPECT_EQ(one.barycentrics, two.barycentrics);
  EXPECT_EQ(one.depths, two.depths);
  EXPECT_GT(one.n_covered, 1000u);
  EXPECT_EQ(one.n_covered, two.n_covered);
}

}  // namespace
}  // namespace lambake
