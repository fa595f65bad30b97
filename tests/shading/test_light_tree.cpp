#include "lambake/shading/light_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "lambake/core/parallel.h"
#include "lambake/core/vector_path.h"
#include "lambake/shading/lambert.h"
#include "lambake/shading/light_field.h"
#include "lambake/shading/light_kernel.h"

namespace lambake {
namespace {

constexpr double step = 1.0 / 255;

struct Random {
  std::mt19937 engine{11};
  float operator()(float low, float high) {
    return low + (high - low) * static_cast<float>(engine()) / 4294967296.0f;
  }
  glm::vec3 in_cube(float half) { return {(*this)(-half, half), (*this)(-half, half), (*this)(-half, half)}; }
  glm::vec3 unit() { return glm::normalize(in_cube(1) + glm::vec3(1e-3f)); }
};

struct Points {
  std::vector<glm::vec3> positions, normals;
};

Points sphere(std::size_t n) {
  Points points;
  for (std::size_t i = 0; i < n; ++i) {  // Fibonacci's: no poles
    const float y = 1 - (2 * static_cast<float>(i) + 1) / static_cast<float>(n);
    const float turn = 2.3999632f * static_cast<float>(i), r = std::sqrt(1 - y * y);
    points.positions.emplace_back(r * std::cos(turn), y, r * std::sin(turn));
    points.normals.push_back(glm::normalize(points.positions.back()));
  }
  return points;
}

Points floor(std::size_t n) {
  Random random;
  Points points;
  for (std::size_t i = 0; i < n; ++i) {
    points.positions.emplace_back(random(-1.5f, 1.5f), 0.0f, random(-1.5f, 1.5f));
    points.normals.emplace_back(0, 1, 0);
  }
  return points;
}

/// Normals turn much among few neighbours, and lamps are far in comparison.
Points rippled_floor(std::size_t n) {
  Points points = floor(n);
  for (std::size_t i = 0; i < n; ++i) {
    const glm::vec3& p = points.positions[i] *= 0.1f;
    points.normals[i] = glm::normalize(glm::vec3(0.4f * std::sin(900 * p.x), 1, 0.4f * std::sin(800 * p.z)));
  }
  return points;
}

/// No two neighbours face the same way.
Points hedgehog(std::size_t n) {
  Random random;
  Points points = sphere(n);
  for (glm::vec3& normal : points.normals) normal = random.unit();
  return points;
}

std::vector<Light> lamps(std::size_t n, float half = 1.5f) {
  Random random;
  std::vector<Light> lights(n);
  for (Light& light : lights) {
    const float s = 4.0f / static_cast<float>(n);
    light.type = LightType::point;
    light.position = random.in_cube(half);
    light.intensity = {random(0, s), random(0, s), random(0, 0.3f * s)};
  }
  return lights;
}

double on_screen(double linear) {
  return srgb_encode(std::clamp(linear, 0.0, 1.0));
}

/// Compares with the equation in double: never further off than certified, and than asked for.
LightError expect_certified(const std::vector<Light>& lights, const Points& points, double tolerance) {
  std::vector<LinearRgb> out(points.positions.size());
  const LightError error = irradiance_within(lights, tolerance, points.positions, points.normals, out);
  EXPECT_LE(error.display, tolerance);
  // Lights that are summed plainly are rounded like any float sum of as many.
  const double rounding = 6e-8 * (static_cast<double>(lights.size()) + 16);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const glm::dvec3 e =
        irradiance<double>(lights, glm::dvec3(points.positions[i]), glm::dvec3(points.normals[i]));
    const float got[] = {out[i].r, out[i].g, out[i].b};
    for (int c = 0; c < 3; ++c) {
      const double slack = rounding * e[c] + 1e-37;  // Below, floats run dry.
      EXPECT_LE(std::abs(got[c] - e[c]), error.linear + slack) << "point " << i << " channel " << c;
      EXPECT_LE(std::abs(on_screen(got[c]) - on_screen(e[c])), error.display + 12.92 * slack)
          << "point " << i << " channel " << c;
      if (testing::Test::HasFailure()) return error;
    }
  }
  return error;
}

/// Compares with the plain sum, where float itself is far off: bright lamps at the horizon.
void expect_certified_from_plain(const std::vector<Light>& lights, const Points& points, double tolerance) {
  std::vector<LinearRgb> out(points.positions.size()), plain = out;
  const LightError error = irradiance_within(lights, tolerance, points.positions, points.normals, out);
  irradiance_within(lights, 0, points.positions, points.normals, plain);
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (out[i] == plain[i]) continue;  // Infinite ones, too.
    const double most = std::max(out[i].r, plain[i].r);
    EXPECT_LE(std::abs(double(out[i].r) - plain[i].r), error.linear + 1e-5 * most) << i;
    EXPECT_LE(std::abs(on_screen(out[i].r) - on_screen(plain[i].r)), error.display + 1e-5) << i;
  }
}

TEST(ManyLights, OnASphere_NoFurtherOffThanCertified) {
  for (const double tolerance : {1.0 * step, 0.25 * step, 0.02 * step}) {
    SCOPED_TRACE(testing::Message() << "tolerance " << tolerance / step << "/255");
    EXPECT_GT(expect_certified(lamps(2000), sphere(6000), tolerance).display, 0) << "nothing was merged";
  }
}

TEST(ManyLights, OnAFloor_NoFurtherOffThanCertified) {
  for (const double tolerance : {1.0 * step, 0.25 * step, 0.02 * step})
    EXPECT_GT(expect_certified(lamps(2000), floor(6000), tolerance).display, 0);
}

TEST(ManyLights, OnARippledFloor_NoFurtherOffThanCertified) {
  for (const double tolerance : {0.25 * step, 0.02 * step})
    EXPECT_GT(expect_certified(lamps(1000), rippled_floor(12000), tolerance).display, 0);
}

TEST(ManyLights, WhereNoTwoNeighboursFaceAlike_NoFurtherOffThanCertified) {
  expect_certified(lamps(1000), hedgehog(3000), 0.25 * step);
}

TEST(ManyLights, LampsInsideAClosedShape_GiveNothing) {
  const Points points = sphere(5000);
  std::vector<LinearRgb> out(points.positions.size(), LinearRgb{9, 9, 9});
  const LightError error =
      irradiance_within(lamps(1000, 0.5f), 0.25 * step, points.positions, points.normals, out);
  for (const LinearRgb& e : out) ASSERT_EQ(e, LinearRgb());
  EXPECT_EQ(error.display, 0);
}

TEST(ManyLights, AnyScaleAndFarFromTheOrigin_NoFurtherOffThanCertified) {
  for (const float scale : {1e-12f, 1e-3f, 1e12f}) {
    Points points = sphere(2000);
    std::vector<Light> lights = lamps(1000);
    for (glm::vec3& p : points.positions) p *= scale;
    for (Light& light : lights) {
      light.position *= scale;
      const float s = scale * scale;
      light.intensity = {light.intensity.r * s, light.intensity.g * s, light.intensity.b * s};
    }
    SCOPED_TRACE(testing::Message() << "scale " << scale);
    EXPECT_GT(expect_certified(lights, points, 0.25 * step).display, 0);
  }
  Points points = sphere(2000);
  std::vector<Light> lights = lamps(1000);
  for (glm::vec3& p : points.positions) p += glm::vec3(1000, -2000, 4000);
  for (Light& light : lights) light.position += glm::vec3(1000, -2000, 4000);
  expect_certified(lights, points, 0.25 * step);
}

TEST(ManyLights, CrowdsOfPointsAmongScatteredOnes_NoFurtherOffThanCertified) {
  // More in one place than are ever taken together, and some so lonely that they share a range with others.
  Points points = sphere(500);
  Random random;
  for (std::size_t i = 0; i < 9000; ++i) {
    points.positions.push_back(points.positions[7]);
    points.normals.push_back(points.normals[7]);
    points.positions.push_back(points.positions[300] + random.in_cube(1e-3f));
    points.normals.push_back(points.normals[300]);
  }
  EXPECT_GT(expect_certified(lamps(600), points, 0.25 * step).display, 0);
}

TEST(ManyLights, LampsAtTheHorizonOfFunnels_NoFurtherOffThanCertified) {
  // Each behind most of a ring's points, next to its axis, and so bright that it lights the one it is before.
  Random random;
  Points points;
  std::vector<Light> lights;
  for (int ring = 0; ring < 64; ++ring) {
    const glm::vec3 middle(0.5f * glm::vec3(ring % 4, ring / 4 % 4, ring / 16) - 0.75f);
    const glm::vec3 axis = glm::normalize(glm::vec3(random(-0.2f, 0.2f), random(-0.2f, 0.2f), 1));
    const glm::vec3 e1 = glm::normalize(glm::cross(axis, glm::vec3(1, 0, 0))), e2 = glm::cross(axis, e1);
    const auto unit = [&](float turn) { return std::cos(turn) * e1 + std::sin(turn) * e2; };
    const float tilt = 0.61f, radius = 0.1f, behind = radius * std::tan(tilt);
    constexpr int n = 100;
    for (int i = 0; i < n; ++i) {
      const glm::vec3 e = unit(2 * std::numbers::pi_v<float> * i / n);
      points.positions.push_back(middle + radius * e);
      points.normals.push_back(glm::normalize(std::cos(tilt) * axis - std::sin(tilt) * e));
    }
    // n·(x − p) = 0 for all of them at middle − behind·axis; a step aside is before some.
    for (int i = 0; i < 12; ++i) {
      const glm::vec3 x = middle + behind * -axis * 1.00004f +
                          behind * random(1e-4f, 4e-4f) * unit(random(0, 2 * std::numbers::pi_v<float>));
      double nearest = 0, facing = 0;
      for (std::size_t k = points.positions.size() - n; k < points.positions.size(); ++k) {
        const glm::dvec3 to = glm::dvec3(x) - glm::dvec3(points.positions[k]);
        if (const double f = glm::dot(glm::dvec3(points.normals[k]), to); f > facing)
          facing = f, nearest = glm::length(to);
      }
      if (!(facing > 1e-7)) continue;
      Light light;
      light.type = LightType::point;
      light.position = x;
      const auto intensity = static_cast<float>(0.02 * nearest * nearest * nearest / facing);
      light.intensity = {intensity, intensity, intensity};
      lights.push_back(light);
    }
  }
  ASSERT_GT(lights.size(), 512U);
  expect_certified_from_plain(lights, points, 0.25 * step);
}

TEST(ManyLights, PointsInOnePlace_FarFromTheMiddle_NoFurtherOffThanCertified) {
  // Coordinates in the space of the tree are floats: they say no better where a lamp is.
  Random random;
  Points points;
  std::vector<Light> lights(512);
  std::vector<glm::vec3> places;
  for (int i = 0; i < 7; ++i) places.push_back(random.in_cube(1));
  for (std::size_t i = 0; i < 9000; ++i) {
    points.positions.push_back(places[i % 7]);
    points.normals.push_back(glm::normalize(glm::vec3(0, 0, 1) + random.in_cube(0.2f)));
  }
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const float height = 0.5f * std::pow(10.0f, random(-5.5f, 0));
    lights[i].type = LightType::point;
    lights[i].position = places[i % 7] + height * glm::normalize(glm::vec3(0, 0, 1) + random.in_cube(0.5f));
    const float intensity = 0.02f * height * height * random(0, 1);
    lights[i].intensity = {intensity, intensity, intensity};
  }
  for (const double tolerance : {0.1, 1e-3}) expect_certified(lights, points, tolerance);
}

TEST(ManyLights, APointOrALampFarFromTheRest_NoFurtherOffThanCertified) {
  for (const float far : {1e5f, 1e7f, 1e10f, 1e22f, 1e38f}) {
    Points points = sphere(3000);
    std::vector<Light> lights = lamps(600);
    points.positions.emplace_back(far, 0, 0);
    points.normals.emplace_back(0, 1, 0);
    for (const double tolerance : {1e-3, 2e-5}) expect_certified(lights, points, tolerance);
    points.positions.back() = {2, 0, 0};
    lights.push_back(lights.back());
    lights.back().position = {0, far, 0};
    expect_certified(lights, points, 1e-3);
  }
}

TEST(ManyLights, LightsThatFloatHardlyHolds_NoFurtherOffThanCertified) {
  for (const float brightest : {1e-38f, 1e30f, 3e38f}) {
    std::vector<Light> lights = lamps(600, 0.15f);
    lights.push_back(lights.back());
    lights.back().intensity = {brightest, 0, 0};
    expect_certified_from_plain(lights, rippled_floor(2000), 1e-3);
  }
}

TEST(ManyLights, OtherKindsAmongThem_AreAddedPlainly) {
  std::vector<Light> lights = lamps(900);
  Light sun;
  sun.direction_to_light = {0, 1, 0};
  lights.insert(lights.begin() + 100, sun);
  lights[300].type = LightType::spot;
  lights[400].decay = 1;
  lights[500].range = 1;
  EXPECT_GT(expect_certified(lights, sphere(3000), 0.25 * step).display, 0);
}

TEST(ManyLights, PointsWithoutDirectionOrPlace_GetWhatTheEquationGivesThem) {
  Points points = sphere(3000);
  points.positions[17].y = std::numeric_limits<float>::quiet_NaN();
  points.positions[18].x = std::numeric_limits<float>::infinity();
  points.normals[19] = glm::vec3(0);
  std::vector<Light> lights = lamps(900);
  Light sun;
  lights.push_back(sun);
  std::vector<LinearRgb> out(3000);
  irradiance_within(lights, 0.25 * step, points.positions, points.normals, out);
  for (const std::size_t i : {17u, 18u, 19u}) {
    const glm::vec3 e = irradiance<float>(lights, points.positions[i], points.normals[i]);
    EXPECT_EQ(out[i], (LinearRgb{e.r, e.g, e.b}));
  }
}

TEST(ManyLights, LampOnAPoint_LightsTheOthers) {
  Points points = floor(3000);
  std::vector<Light> lights = lamps(900);
  for (std::size_t i = 0; i < 50; ++i) lights[i].position = points.positions[7 * i];
  expect_certified(lights, points, 0.25 * step);
}

TEST(ManyLights, ToleranceZeroOrFewLights_IsThePlainSumToTheLastBit) {
  const Points points = sphere(3000);
  for (const auto& [n, tolerance] : {std::pair{900, 0.0}, std::pair{100, step}}) {
    const std::vector<Light> lights = lamps(static_cast<std::size_t>(n));
    std::vector<LinearRgb> out(3000), plain(3000);
    const LightError error = irradiance_within(lights, tolerance, points.positions, points.normals, out);
    irradiance(pack_lights(lights), points.positions, points.normals, plain);
    EXPECT_EQ(out, plain);
    EXPECT_EQ(error.display, 0);
    EXPECT_EQ(error.linear, 0);
  }
}

TEST(ManyLights, AnyNumberOfThreadsAndAnyVectorPath_GiveTheSameBits) {
  const Points smooth = sphere(20000), rippled = rippled_floor(20000);
  const std::vector<Light> lights = lamps(1500);
  const auto bake = [&] {
    std::vector<LinearRgb> out(40000);
    const std::span all(out);
    irradiance_within(lights, 0.25 * step, smooth.positions, smooth.normals, all.first(20000));
    irradiance_within(lights, 0.25 * step, rippled.positions, rippled.normals, all.last(20000));
    return out;
  };
  const std::vector<LinearRgb> expected = bake();
  set_thread_count(1);
  EXPECT_EQ(bake(), expected) << "one thread";
  set_thread_count(0);
  for (const std::string& path : vector_paths()) {
    choose_vector_path(path);
    EXPECT_EQ(bake(), expected) << path;
  }
  choose_vector_path("");
}

/// n lights without padding, of the channels (1, 0.5, 0.25).
LightArrays arrays_of(const std::vector<glm::vec3>& places) {
  LightArrays lights;
  lights.reserve(places.size());
  lights.size = places.size();
  for (std::size_t i = 0; i < places.size() + LightArrays::lane_padding; ++i) {
    const bool exists = i < places.size();
    const glm::vec3& p = places[exists ? i : 0];
    lights.x[i] = p.x, lights.y[i] = p.y, lights.z[i] = p.z;
    lights.r[i] = exists ? 1.0f : 0.0f, lights.g[i] = 0.5f * lights.r[i], lights.b[i] = 0.25f * lights.r[i];
  }
  return lights;
}

TEST(LightField, HandedDownToSmallerBalls_IsTheSameField) {
  Random random;
  std::vector<glm::vec3> places;
  for (int i = 0; i < 40; ++i) places.push_back(glm::vec3(3, -2, 1) + random.unit() * random(0.5f, 4.0f));
  LightField field;
  field.center = {3, -2, 1};
  field.radius = 0.25f;
  add_lights(field, arrays_of(places));
  std::vector<LightField> parts(6);  // more than are handed down at once, and not a multiple of it
  for (LightField& part : parts) {
    part.radius = random(0.01f, 0.1f);
    part.center = field.center + random.unit() * (0.25f - part.radius);
    part.coefficients[1][3] = 9;
  }
  translate(field, parts);
  for (const LightField& part : parts) {
    LightField part_of_part;
    part_of_part.radius = 0.5f * part.radius;
    part_of_part.center = part.center + random.unit() * part_of_part.radius;
    translate(part, std::span(&part_of_part, 1));
    PointArrays expected, once, twice;
    for (PointArrays* points : {&expected, &once, &twice}) points->resize(16);
    for (std::size_t i = 0; i < 16; ++i) {
      const glm::vec3 p = part_of_part.center + random.unit() * part_of_part.radius, n = random.unit();
      for (PointArrays* points : {&expected, &once, &twice}) {
        points->x[i] = p.x, points->y[i] = p.y, points->z[i] = p.z;
        points->nx[i] = n.x, points->ny[i] = n.y, points->nz[i] = n.z;
      }
    }
    add_irradiance(field, expected, 0, 16);
    add_irradiance(part, once, 0, 16);
    add_irradiance(part_of_part, twice, 0, 16);
    // Rounding, in units of what 40 lamps at distances from 0.5 on give: up to 40.
    for (std::size_t i = 0; i < 16; ++i)
      for (const PointArrays* points : {&once, &twice}) {
        EXPECT_NEAR(points->r[i], expected.r[i], 4e-5f);
        EXPECT_NEAR(points->g[i], expected.g[i], 2e-5f);
        EXPECT_NEAR(points->b[i], expected.b[i], 1e-5f);
      }
  }
}

/// One lamp at distance 1 of a ball of radius q, as its field against the equation.
TEST(LightField, OneLamp_ErrorIsBelowTheRemainder) {
  Random random;
  for (const float q : {0.05f, 0.2f, 0.4f, 0.6f}) {
    double worst = 0;
    for (int k = 0; k < 200; ++k) {
      Light lamp;
      lamp.type = LightType::point;
      lamp.position = random.unit();
      LightArrays lights;
      lights.reserve(1);
      lights.size = 1;
      for (std::size_t i = 0; i < 1 + LightArrays::lane_padding; ++i)
        lights.x[i] = lamp.position.x, lights.y[i] = lamp.position.y, lights.z[i] = lamp.position.z;
      lights.r[0] = 1, lights.g[0] = 0.5f;
      LightField field;
      field.radius = q;
      add_lights(field, lights);
      PointArrays points;
      points.resize(64);
      std::vector<glm::vec3> p(64), n(64);
      for (std::size_t i = 0; i < 64; ++i) {
        p[i] = random.unit() * q;
        n[i] = glm::normalize(lamp.position - p[i]);
        points.x[i] = p[i].x, points.y[i] = p[i].y, points.z[i] = p[i].z;
        points.nx[i] = n[i].x, points.ny[i] = n[i].y, points.nz[i] = n[i].z;
      }
      add_irradiance(field, points, 0, 64);
      for (std::size_t i = 0; i < 64; ++i) {
        const double e = received<double>(lamp, glm::dvec3(p[i]), glm::dvec3(n[i]));
        worst = std::max(worst, std::abs(points.r[i] - e));
        EXPECT_NEAR(points.g[i], 0.5f * points.r[i], 1e-5f * points.r[i]);
        EXPECT_EQ(points.b[i], 0);
      }
    }
    const double bound = LightField::remainder(static_cast<double>(q));
    EXPECT_LE(worst, bound + 2e-5) << "q " << q;
    // Along the line to the lamp the terms of the series add up, so the bound is not far above.
    if (q >= 0.2f) {
      EXPECT_GE(worst, 0.2 * bound) << "q " << q;
    }
  }
}

}  // namespace
}  // namespace lambake
