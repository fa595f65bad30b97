#include "lambake/measure/error_shares.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lambake/measure/surface_error.h"
#include "scenes.h"

namespace lambake {
namespace {

ErrorShares shares_of(const Scene& scene, const BakedColors& baked, const ColorOutput& output) {
  return error_shares(scene, baked, output, surface_error(scene, baked, ErrorSpace::linear).rmse);
}

TEST(ErrorShares, FlatGridThatClips_ErrsByTheClippingAlone) {
  const Scene scene = scene_of(grid(2, 1), {sun({0, 1, 0}, {1.5f, 1, 0.25f})});
  const ErrorShares shares = shares_of(scene, bake(scene, {}), storing([](const LinearRgb& c) {
                                         return LinearRgb{std::min(c.r, 1.0f), c.g, c.b};
                                       }));
  EXPECT_LT(shares.interpolation, 1e-15);  // rounding of the interpolation
  EXPECT_NEAR(shares.clipping, 0.5 / std::sqrt(3.0), 1e-12);
  EXPECT_EQ(shares.quantisation, 0);
}

LinearRgb in_eighths(const LinearRgb& c) {
  const auto step = [](float x) { return std::round(x * 8) / 8; };
  return {step(c.r), step(c.g), step(c.b)};
}

TEST(ErrorShares, CoarseSteps_AreTheQuantisation) {
  const Scene scene = scene_of(icosphere(3), {sun({0.4f, 1, 0.3f})});
  BakedColors baked = bake(scene, {});
  const ErrorShares shares = shares_of(scene, baked, storing(in_eighths));
  EXPECT_EQ(shares.clipping, 0);
  // A value is off by 1/8/√12 in the mean square where it is spread evenly; half of the sphere is black.
  EXPECT_GT(shares.quantisation, 0.3 * 0.125 / std::sqrt(12.0));
  EXPECT_LT(shares.quantisation, 0.125 / std::sqrt(12.0));
  for (LinearRgb& c : baked.colors) c = in_eighths(c);
  const double whole = surface_error(scene, baked, ErrorSpace::linear).rmse;
  EXPECT_NEAR(std::hypot(shares.interpolation, shares.quantisation), whole, 0.05 * whole);
}

// Stripes of black and white across a square: half of the surface shows nothing of what is clipped.
TEST(ErrorShares, Texture_WeighsWhatIsClipped) {
  Scene scene = scene_of(grid(2, 1), {sun({0, 1, 0}, {1.5f, 1, 0.25f})});
  for (const glm::vec3& p : scene.mesh.positions) scene.mesh.texcoords[0].push_back({p.x, p.z});
  scene.textures = {{.image = 0, .filter = TextureFilter::nearest}};
  scene.materials[0].base_color_texture = 0;
  const ColorOutput output = storing([](const LinearRgb& c) {
    return LinearRgb{std::min(c.r, 1.0f), std::round(c.g * 8) / 8, std::round(c.b * 8) / 8 + 0.25f};
  });
  const auto shares_with = [&](const std::vector<glm::vec4>& texels) {
    Image image;
    image.width = static_cast<std::uint32_t>(texels.size()), image.height = 1;
    image.pixels = texels;
    scene.images = {image};
    return shares_of(scene, bake(scene, {}), output);
  };
  const double clipping = 0.5 / std::sqrt(3.0), rounding = 0.25 / std::sqrt(3.0);
  for (const float grey : {1.0f, 0.25f, 0.0f}) {
    const ErrorShares shares = shares_with({glm::vec4(glm::vec3(grey), 1)});
    EXPECT_NEAR(shares.clipping, grey * clipping, 1e-6) << grey;
    EXPECT_NEAR(shares.quantisation, grey * rounding, 1e-6) << grey;
  }
  const ErrorShares striped = shares_with({glm::vec4(0, 0, 0, 1), glm::vec4(1)});
  EXPECT_NEAR(striped.clipping, clipping * std::sqrt(0.5), 0.01 * clipping);
  EXPECT_NEAR(striped.quantisation, rounding * std::sqrt(0.5), 0.01 * rounding);
}

TEST(ErrorShares, OfAdaptive_AreThoseOfItsColoursAsComputed) {
  const Scene scene = scene_of(icosphere(2), {sun({0.4f, 1, 0.3f})});
  const ColorOutput output = storing(in_eighths);
  const ErrorShares shares =
      shares_of(scene, bake(scene, {.method = BakeMethod::adaptive, .output = output}), output);
  EXPECT_GT(shares.interpolation, 0);
  EXPECT_EQ(shares.clipping, 0);
  EXPECT_GT(shares.quantisation, 0.3 * 0.125 / std::sqrt(12.0));
}

}  // namespace
}  // namespace lambake
