#include "lambake/shading/patch_bound.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numeric>
#include <vector>

#include "lambake/core/parallel.h"
#include "lambake/core/vector_path.h"
#include "shading/random.h"

namespace lambake {
namespace {

Light random_light(Random& random, const Patch& patch) {
  Light light;
  const int kind = random.below(4);
  light.intensity = {static_cast<float>(random.scale(0.01, 4)), static_cast<float>(random(0, 1)),
                     static_cast<float>(random.below(2))};
  const glm::dvec3 middle = patch.positions * glm::dvec3(1.0 / 3);
  glm::dvec3 direction = random.unit();
  // Often at a grazing angle, where the terminator is.
  const glm::dvec3 n = glm::normalize(patch.normals * glm::dvec3(random(0, 1), random(0, 1), 0.1));
  if (random.below(2) == 0)
    direction = glm::normalize(direction - n * glm::dot(n, direction) * random(0.8, 1));
  if (kind == 0) {
    light.direction_to_light = glm::vec3(direction);
    return light;
  }
  light.type = kind == 3 ? LightType::spot : LightType::point;
  const double distance = random.scale(1e-3, 30);
  light.position = glm::vec3(middle + distance * direction);
  const float decays[] = {0, 0.5f, 1, 2, 2, 3.3f, 4};
  light.decay = decays[random.below(7)];
  const float brightness = static_cast<float>(std::pow(distance, light.decay));
  light.intensity = light.intensity * brightness;
  if (random.below(3) == 0) light.range = static_cast<float>(distance * random(0.5, 3));
  light.spot_direction = glm::vec3(glm::normalize(-direction + random(0, 0.6) * random.unit()));
  light.inner_cone_rad = static_cast<float>(random(0, 0.7));
  light.outer_cone_rad = light.inner_cone_rad + static_cast<float>(random.scale(1e-3, 0.8));
  return light;
}

Patch random_patch(Random& random) {
  Patch patch;
  const double size = random.scale(1e-3, 3), spread = random.scale(1e-4, 3), squash = random.scale(1e-7, 1);
  const glm::dvec3 n = random.unit(), along = random.unit(), corner = random.unit();
  for (int c = 0; c < 3; ++c) {
    glm::dvec3 p = size * random.unit();
    if (random.below(2) == 0) p = along * glm::dot(p, along) + squash * p;  // a sliver
    patch.positions[c] = corner + p;
    glm::dvec3 normal = n + spread * random.unit();
    if (random.below(64) == 0) normal = -patch.normals[0] + 1e-3 * random.unit();  // vanishes inside
    if (random.below(64) == 0) normal = glm::dvec3(0);
    const double length = glm::length(normal);
    // Not unit, as inside a larger triangle; a file may have them longer as well.
    patch.normals[c] = length > 0 ? normal / length * random(0.7, 1.3) : normal;
    if (random.below(2) == 0) patch.albedos[c] = {random(0, 1), random(0, 1), 1};
  }
  return patch;
}

// Next to a vertex without a normal the interpolated ones have one direction and very different lengths:
// there is no error, and a few parts are enough to see it.
TEST(PatchBound, NormalsOfOneDirection_ShowNoError) {
  Light light;
  light.direction_to_light = glm::normalize(glm::vec3(1, 2, 0.5f));
  const std::vector<Light> lights{light};
  const std::vector<std::uint32_t> indices{0};
  for (const auto& lengths : {glm::dvec3(0.25, 0.2, 0.1), {0.1, 1, 0.9}, {0.7, 0.05, 0.6}}) {
    Patch patch;
    patch.positions = {glm::dvec3(0), glm::dvec3(1, 0, 0), glm::dvec3(0.3, 0, 1)};
    for (int c = 0; c < 3; ++c) {
      patch.normals[c] = lengths[c] * glm::dvec3(0, 1, 0);
      patch.colors[c] = reference_at(patch, lights, indices, false, glm::dvec3(c == 0, c == 1, c == 2));
    }
    EXPECT_LT(bound_patch(patch, {}, lights, indices, {.accept = 0.1 / 255, .tightness = 1}).bound,
              0.1 / 255);
  }
}

/// The bound of what sampled colours, clipped to white, leave under one white lamp is not below the error at
/// places between the corners.
void expect_bounded(Patch patch, const Light& lamp, int max_parts) {
  const std::vector<Light> lights{lamp};
  const std::vector<std::uint32_t> all{0};
  for (int k = 0; k < 3; ++k) {
    glm::dvec3 corner(0);
    corner[k] = 1;
    patch.colors[k] = glm::min(reference_at(patch, lights, all, false, corner), glm::dvec3(1));
  }
  BoundOptions options;
  options.max_parts = max_parts;
  options.accept = options.reject = 1.0 / 255;
  options.tightness = 1;
  const PatchBound result = bound_patch(patch, {}, lights, all, options);
  constexpr int n = 20;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      const glm::dvec3 place = glm::dvec3(i, j, n - i - j) / double(n);
      const double f = reference_at(patch, lights, all, false, place).r, g = (patch.colors * place).r;
      EXPECT_LE(std::abs(compared(f, options.space) - compared(g, options.space)), result.bound)
          << "at " << place.x << ", " << place.y;
    }
}

// The enclosures of quadratic parts must not cancel where one side is next to nothing.
TEST(PatchBound, NeedleUnderALamp_IsBounded) {
  Light lamp;
  lamp.type = LightType::point;
  lamp.position = {0, 0.5f, 0.05f};
  lamp.intensity = LinearRgb{1, 1, 1} * 1e-4f;
  Patch patch;
  patch.normals = {glm::dvec3(0, 0, 1), glm::dvec3(0, 0, 1), glm::dvec3(0, 0, 1)};
  for (const double half : {5.5e-9, 1e-8, 3e-8, 1e-6})
    for (const int max_parts : {1, 60}) {
      patch.positions = {glm::dvec3(-half, 0, 0), glm::dvec3(half, 0, 0), glm::dvec3(0, 1, 0)};
      expect_bounded(patch, lamp, max_parts);
    }
}

// Powers that leave double give no number, which is no bound of 0.
TEST(PatchBound, SteepestFalloff_IsBounded) {
  std::mt19937_64 random(1);
  const auto between = [&](double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>()(random);
  };
  Light lamp;
  lamp.type = LightType::point;
  lamp.decay = 400;
  for (int i = 0; i < 3000; ++i) {
    const auto height = static_cast<float>(std::exp(between(std::log(1e-3), 0)));
    lamp.position = {between(-0.3, 1), between(-0.3, 1), height};
    Patch patch;
    patch.positions = {glm::dvec3(0), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)};
    for (int c = 0; c < 3; ++c)
      patch.normals[c] = glm::normalize(glm::dvec3(between(-1, 1), between(-1, 1), between(0, 1)));
    expect_bounded(patch, lamp, 60);
  }
}

// Lights are enclosed four at a time, on some paths with fewer lanes.
TEST(PatchBound, EveryVectorPath_SameBits) {
  std::vector<Patch> patches;
  std::vector<std::vector<Light>> lights;
  Random random{std::mt19937_64(7)};
  for (int i = 0; i < 300; ++i) {
    patches.push_back(random_patch(random));
    lights.emplace_back();
    for (int n = 1 + random.below(13); n > 0; --n)
      lights.back().push_back(random_light(random, patches.back()));
  }
  const auto bounds = [&] {
    std::vector<double> all;
    for (std::size_t i = 0; i < patches.size(); ++i) {
      std::vector<std::uint32_t> indices;
      find_reaching_lights(lights[i], patches[i], indices);
      const PatchBound b = bound_patch(patches[i], {}, lights[i], indices, {.max_parts = 20});
      all.insert(all.end(), {b.bound, b.found, b.found_at.x, b.found_at.y});
    }
    return all;
  };
  const std::vector<double> best = bounds();
  for (const std::string& path : vector_paths()) {
    choose_vector_path(path);
    EXPECT_EQ(bounds(), best) << path;
  }
  choose_vector_path("");
}

TEST(PatchBound, OneLight_LiesWithinItsEnclosure) {
  int n_checked = 0;
  Random random{std::mt19937_64(3)};
  for (int i = 0; i < 2000; ++i) {
    const Patch patch = random_patch(random);
    const Light light = random_light(random, patch);
    const Enclosure alone = light_over(light, patch);
    if (!std::isfinite(alone.high)) continue;
    for (int k = 0; k < 20; ++k) {
      const double u = random(0, 1), v = random(0, 1 - u);
      const glm::dvec3 b(1 - u - v, u, v);
      const glm::dvec3 n = patch.normals * b;
      if (!(glm::length(n) > 0)) continue;
      const double polynomial = b.x * alone.linear[0] + b.y * alone.linear[1] + b.z * alone.linear[2] +
                                b.x * b.y * alone.quadratic[0] + b.y * b.z * alone.quadratic[1] +
                                b.z * b.x * alone.quadratic[2];
      ++n_checked;
      const double value = received(light, patch.positions * b, glm::normalize(n));
      EXPECT_LE(polynomial + alone.low, value * (1 + 1e-9) + 1e-300) << i;
      EXPECT_GE(polynomial + alone.high, value * (1 - 1e-9) - 1e-300) << i;
    }
  }
  EXPECT_GT(n_checked, 20000);
}

TEST(PatchBound, MillionRandomCases_NoSampleIsAboveTheBound) {
#ifdef __SANITIZE_ADDRESS__
  constexpr std::size_t n_cases = 50'000;  // ten times slower there
#else
  constexpr std::size_t n_cases = 1'000'000;
#endif
  constexpr std::size_t block = 2000;
  std::atomic<std::size_t> n_above{0}, n_finite{0};
  std::vector<double> ratios(n_cases, -1.0);
  parallel_blocks(n_cases, block, [&](std::size_t begin, std::size_t end) {
    Random random{std::mt19937_64(begin)};
    for (std::size_t i = begin; i < end; ++i) {
      Patch patch = random_patch(random);
      std::vector<Light> lights;
      const int most[] = {3, 3, 3, 9};
      for (int n = 1 + random.below(most[random.below(4)]); n > 0; --n)
        lights.push_back(random_light(random, patch));
      if (random.below(3) == 0)  // white light, where one channel stands for all
        for (Light& light : lights) light.intensity.g = light.intensity.b = light.intensity.r;
      std::vector<std::uint32_t> indices;
      find_reaching_lights(lights, patch, indices);
      std::vector<std::uint32_t> all(lights.size());
      std::iota(all.begin(), all.end(), 0U);

      // Colours as sampled; as some other method makes them, below 0 and above 1 too; or of no relation.
      const double noise = random.below(2) == 0 ? 0 : random.scale(1e-5, 1);
      for (int c = 0; c < 3; ++c) {
        glm::dvec3 b(0);
        b[c] = 1;
        patch.colors[c] = reference_at(patch, lights, all, false, b) + noise * random.unit();
      }
      FinishRange finish;
      finish.base_high = {random(0, 1), random(0, 1), 1};
      if (random.below(3) == 0) finish.base_high = glm::dvec3(random(0, 1));
      finish.base_low = random.below(2) == 0 ? finish.base_high : finish.base_high * random(0, 1);
      finish.emission_low = finish.emission_high = glm::dvec3(random.below(2) == 0 ? 0 : random(0, 0.5));
      const int max_parts[] = {1, 1, 6, 60};
      BoundOptions options;
      options.space = random.below(2) == 0 ? ErrorSpace::linear : ErrorSpace::display;
      options.max_parts = max_parts[random.below(4)];
      if (random.below(4) == 0) options.accept = random.scale(1e-4, 1);
      const PatchBound result = bound_patch(patch, finish, lights, indices, options);

      double sampled = 0;
      constexpr int n = 6;
      for (int u = 0; u <= n; ++u)
        for (int v = 0; u + v <= n; ++v) {
          const glm::dvec3 b(1 - double(u + v) / n, double(u) / n, double(v) / n);
          const glm::dvec3 f = reference_at(patch, lights, all, false, b), g = patch.colors * b;
          const glm::dvec3 base = glm::mix(finish.base_low, finish.base_high, random(0, 1));
          for (int c = 0; c < 3; ++c) {
            // In linear the emission cancels; adding it would only round.
            const double emission = options.space == ErrorSpace::linear ? 0 : finish.emission_low[c];
            sampled = std::max(sampled, std::abs(compared(emission + base[c] * f[c], options.space) -
                                                 compared(emission + base[c] * g[c], options.space)));
          }
        }
      if (!(sampled <= result.bound) || !(result.found <= result.bound)) {
        if (++n_above < 5) {
          ADD_FAILURE() << "case " << i << ": sampled " << sampled << ", found " << result.found << ", bound "
                        << result.bound;
        }
      }
      if (std::isfinite(result.bound)) ++n_finite;
      if (options.max_parts == 60 && options.accept == 0 && finish.base_low == finish.base_high &&
          sampled > 1e-4)
        ratios[i] = result.bound / sampled;
    }
  });
  EXPECT_EQ(n_above, 0U);
  EXPECT_GT(n_finite, n_cases / 2);
  std::erase_if(ratios, [](double r) { return r < 0; });
  std::sort(ratios.begin(), ratios.end());
  // The other side: the bound is no wild guess, even of cases as hard as these.
  ASSERT_GT(ratios.size(), n_cases / 20);
  EXPECT_LT(ratios[ratios.size() / 2], 1.3);
}

}  // namespace
}  // namespace lambake
