#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "lambake/bake/bake.h"
#include "lambake/geometry/normals.h"
#include "lambake/measure/bound.h"
#include "lambake/measure/surface_error.h"
#include "shapes.h"

/// What the sweeps over the places where methods fail have in common.
namespace lambake {

inline constexpr double pi = 3.14159265358979323846;
inline constexpr std::array every_method = {BakeMethod::face,    BakeMethod::sample,
                                            BakeMethod::average, BakeMethod::least_squares,
                                            BakeMethod::uniform, BakeMethod::adaptive};

inline Light sun(const glm::vec3& towards, float intensity = 1) {
  return {.intensity = LinearRgb{1, 1, 1} * intensity, .direction_to_light = glm::normalize(towards)};
}

inline Light lamp(const glm::vec3& position, float intensity = 1, float decay = 2) {
  Light light;
  light.type = LightType::point;
  light.position = position;
  light.intensity = LinearRgb{1, 1, 1} * intensity;
  light.decay = decay;
  return light;
}

/// The mesh under the lights; normals weighted by angle where it has none.
inline Scene scene_of(Mesh mesh, std::vector<Light> lights) {
  Scene scene;
  if (mesh.normals.empty()) mesh.normals = vertex_normals(mesh, NormalWeight::angle).normals;
  scene.mesh = std::move(mesh);
  scene.materials.resize(1);
  scene.lights = std::move(lights);
  return scene;
}

/// Two triangles side by side, flat in y = 0, that share the edge from (0, 0, −1) to (0, 0, 1).
inline Mesh two_triangles() {
  Mesh mesh;
  mesh.positions = {{0, 0, -1}, {0, 0, 1}, {1, 0, 0}, {-1, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
  return mesh;
}

struct Measured {
  BakedColors baked;
  SurfaceError error;  ///< Linear.
  SurfaceBound bound;  ///< Linear.
};

/// Whether `adaptive` has promised that no place is more than 1/255 off on screen.
inline bool is_certified(const Measured& m) {
  return m.baked.certificate && m.baked.certificate->is_certified;
}

/// Bakes and measures, and expects what holds of every scene and method: each colour finite, each error
/// finite, the bound not below what sampling finds, and that what is certified holds.
/// @param max_vertices  for `adaptive`.
inline Measured measure(const Scene& scene, BakeMethod method = BakeMethod::sample,
                        std::size_t max_vertices = 5000) {
  SCOPED_TRACE(testing::Message() << "method " << static_cast<int>(method));
  Measured m;
  m.baked = bake(scene, {.method = method, .max_vertices = max_vertices});
  for (const LinearRgb& c : m.baked.colors) EXPECT_TRUE(is_finite(c));
  m.error = surface_error(scene, m.baked, ErrorSpace::linear);
  EXPECT_TRUE(std::isfinite(m.error.rmse) && std::isfinite(m.error.max_sampled));
  m.bound = surface_bound(scene, m.baked, {.space = ErrorSpace::linear});
  EXPECT_FALSE(std::isnan(m.bound.max_bound));
  EXPECT_GE(m.bound.max_bound, m.error.max_sampled * (1 - 1e-6));
  if (is_certified(m)) {
    EXPECT_LE(surface_error(scene, m.baked, ErrorSpace::display).max_sampled, 1.0 / 255 + 1e-9);
    EXPECT_LE(m.baked.certificate->max_bound, 1.0 / 255);
  }
  return m;
}

/// The largest error is found by sampling to within a few percent, and bounded closely.
inline void expect_max(const Measured& m, double truth) {
  EXPECT_LE(m.error.max_sampled, truth * (1 + 1e-5) + 1e-7);
  EXPECT_GE(m.error.max_sampled, 0.95 * truth - 1e-7);
  EXPECT_GE(m.bound.max_bound, truth * (1 - 1e-6) - 1e-7);
  EXPECT_LE(m.bound.max_bound, 1.2 * truth + 1e-6);
}

}  // namespace lambake
