#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "lambake/geometry/normals.h"
#include "lambake/scene/scene.h"
#include "measure/storing.h"
#include "shapes.h"

/// Scenes that the tests of measuring and baking share.
namespace lambake {

inline Scene scene_of(Mesh mesh, std::vector<Light> lights) {
  Scene scene;
  scene.mesh = std::move(mesh);
  if (scene.mesh.normals.empty())
    scene.mesh.normals = vertex_normals(scene.mesh, NormalWeight::angle).normals;
  scene.materials.resize(1);
  scene.lights = std::move(lights);
  return scene;
}

inline Light sun(const glm::vec3& direction_to_light, const LinearRgb& intensity = {1, 1, 1}) {
  Light light;
  light.direction_to_light = glm::normalize(direction_to_light);
  light.intensity = intensity;
  return light;
}

inline Light lamp(const glm::vec3& position, const LinearRgb& intensity = {1, 1, 1}, float decay = 2) {
  Light light;
  light.type = LightType::point;
  light.position = position;
  light.intensity = intensity;
  light.decay = decay;
  return light;
}

inline Light spot(const glm::vec3& position, const glm::vec3& direction, float inner, float outer) {
  Light light = lamp(position);
  light.type = LightType::spot;
  light.spot_direction = glm::normalize(direction);
  light.inner_cone_rad = inner;
  light.outer_cone_rad = outer;
  return light;
}

struct NamedScene {
  std::string name;
  Scene scene;
};

/// Small scenes that have among them every kind of light, terminators, range and cone edges, several lights,
/// colours that clip, and vertex base colours.
inline std::vector<NamedScene> small_scenes() {
  std::vector<NamedScene> scenes;
  const Light main_sun = sun({0.4f, 1, 0.3f});
  scenes.push_back({"icosphere 2, sun", scene_of(icosphere(2), {main_sun})});
  scenes.push_back({"icosphere 3, sun", scene_of(icosphere(3), {main_sun})});
  scenes.push_back(
      {"icosphere 2, near lamp", scene_of(icosphere(2), {lamp({0.6f, 1.1f, 0.2f}, {0.3f, 0.2f, 0.1f})})});
  scenes.push_back({"icosphere 2, sun and two lamps",
                    scene_of(icosphere(2), {main_sun, lamp({1.5f, 0.3f, 0.2f}, {0.4f, 0.1f, 0.1f}),
                                            lamp({-0.8f, 0.6f, 1.4f}, {0.1f, 0.3f, 0.9f}, 1)})});
  scenes.push_back({"quad under a lamp", scene_of(grid(1, 1), {lamp({0, 0.25f, 0}, {0.05f, 0.05f, 0.05f})})});
  Light ranged = lamp({0.1f, 0.5f, -0.2f}, {0.2f, 0.2f, 0.2f}, 1);
  ranged.range = 0.9f;
  scenes.push_back({"grid, lamp with a range", scene_of(grid(6, 1), {ranged})});
  scenes.push_back(
      {"grid, spot", scene_of(grid(6, 1), {spot({0.1f, 0.9f, 0.2f}, {0.1f, -1, 0}, 0.3f, 0.6f)})});
  scenes.push_back(
      {"hills, low sun that clips", scene_of(height_field(8), {sun({1, 0.2f, 0.1f}, {3, 2, 1})})});
  scenes.push_back({"torus knot, sun", scene_of(torus_knot(48, 8, 0.15f), {main_sun})});
  return scenes;
}

}  // namespace lambake
