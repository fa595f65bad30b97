#include "lambake/shading/texture.h"

#include <gtest/gtest.h>

#include <limits>

namespace lambake {
namespace {

/// A row of four texels whose red is 0, 1, 2, 3.
Scene row_scene(TextureFilter filter, TextureWrap wrap) {
  Scene scene;
  scene.images.push_back({4, 1, {{0, 0, 0, 1}, {1, 0, 0, 1}, {2, 0, 0, 1}, {3, 0, 0, 1}}});
  scene.textures.emplace_back();
  scene.textures[0].filter = filter;
  scene.textures[0].wrap_s = scene.textures[0].wrap_t = wrap;
  return scene;
}

float red(const Scene& scene, float u) {
  return sample_texture(scene, scene.textures[0], {u, 0.5f}).r;
}

TEST(SampleTexture, Nearest_TakesTheTexelThatHoldsThePlace) {
  const Scene scene = row_scene(TextureFilter::nearest, TextureWrap::repeat);
  for (int i = 0; i < 4; ++i)
    for (const float inside : {0.01f, 0.5f, 0.99f}) {
      EXPECT_EQ(red(scene, (float(i) + inside) / 4), float(i));
      EXPECT_EQ(red(scene, (float(i) + inside) / 4 - 3), float(i));
    }
}

TEST(SampleTexture, Linear_IsTheTexelAtItsCentreAndTheRampBetween) {
  for (const TextureWrap wrap :
       {TextureWrap::repeat, TextureWrap::clamp_to_edge, TextureWrap::mirrored_repeat}) {
    const Scene scene = row_scene(TextureFilter::linear, wrap);
    for (float x = 0.5f; x <= 3.5f; x += 0.25f) EXPECT_FLOAT_EQ(red(scene, x / 4), x - 0.5f);
  }
}

TEST(SampleTexture, BeyondTheEdge_EachWrapModeAsNamed) {
  const Scene repeat = row_scene(TextureFilter::linear, TextureWrap::repeat);
  EXPECT_FLOAT_EQ(red(repeat, 0), 1.5f);  // halfway from the last to the first
  EXPECT_FLOAT_EQ(red(repeat, 1), 1.5f);
  EXPECT_FLOAT_EQ(red(repeat, 5.5f / 4), 1.0f);
  EXPECT_FLOAT_EQ(red(repeat, -2.5f / 4), 1.0f);
  const Scene clamp = row_scene(TextureFilter::linear, TextureWrap::clamp_to_edge);
  EXPECT_FLOAT_EQ(red(clamp, -7), 0);
  EXPECT_FLOAT_EQ(red(clamp, 1.01f), 3);
  const Scene mirror = row_scene(TextureFilter::linear, TextureWrap::mirrored_repeat);
  EXPECT_FLOAT_EQ(red(mirror, 1), 3);
  EXPECT_FLOAT_EQ(red(mirror, 5.5f / 4), 2.0f);
  EXPECT_FLOAT_EQ(red(mirror, -1.5f / 4), 1.0f);
  EXPECT_FLOAT_EQ(red(mirror, 2 + 1.5f / 4), 1.0f);
}

TEST(SampleTexture, Rows_GoDownFromTheTop) {
  Scene scene;
  scene.images.push_back({1, 2, {{1, 0, 0, 1}, {0, 1, 0, 0.5f}}});
  scene.textures.emplace_back();
  EXPECT_EQ(sample_texture(scene, scene.textures[0], {0.5f, 0.25f}), glm::vec4(1, 0, 0, 1));
  EXPECT_EQ(sample_texture(scene, scene.textures[0], {0.5f, 0.75f}), glm::vec4(0, 1, 0, 0.5f));
  EXPECT_EQ(sample_texture(scene, scene.textures[0], {0.5f, 0.5f}), glm::vec4(0.5f, 0.5f, 0, 0.75f));
}

TEST(SampleTexture, Transform_IsAppliedToTheCoordinates) {
  Scene scene = row_scene(TextureFilter::nearest, TextureWrap::repeat);
  scene.textures[0].transform = glm::mat3({2, 0, 0}, {0, 1, 0}, {0.25f, 0, 1});  // u' = 2u + 1/4
  EXPECT_EQ(red(scene, 0.05f), 1.0f);
  EXPECT_EQ(red(scene, 0.3f), 3.0f);
}

TEST(SampleTexture, CoordinatesThatAreNotFiniteOrHuge_GiveSomeTexel) {
  for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::linear})
    for (const TextureWrap wrap :
         {TextureWrap::repeat, TextureWrap::clamp_to_edge, TextureWrap::mirrored_repeat}) {
      const Scene scene = row_scene(filter, wrap);
      for (const float u : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity(), 3e38f, -3e38f, -1e-30f}) {
        EXPECT_GE(red(scene, u), 0);
        EXPECT_LE(red(scene, u), 3);
      }
    }
}

TEST(SampleTexture, ImageWithoutPixels_IsWhite) {
  Scene scene;
  scene.images.emplace_back();
  scene.textures.emplace_back();
  EXPECT_EQ(sample_texture(scene, scene.textures[0], {0.3f, 0.4f}), glm::vec4(1));
}

}  // namespace
}  // namespace lambake
