#include "lambake/io/gltf/lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lambake/core/error.h"
#include "lambake/io/gltf/source.h"

namespace lambake {
namespace {

glm::dvec3 direction_of(const glm::dvec3& v, const GltfAsset& asset, std::size_t node) {
  const double length = glm::length(v);
  if (!(length > 0) || !std::isfinite(length))
    throw InvalidScene(
        fmt::format("{}: nodes[{}]: its matrix leaves no direction for the light or camera that it holds",
                    asset.path, node));
  return v / length;
}

}  // namespace

std::optional<Light> read_gltf_light(const GltfAsset& asset, std::size_t node, const glm::dmat4& world) {
  const GltfJson& reference =
      member(member(member(member(asset.json, "nodes")[node], "extensions"), "KHR_lights_punctual"), "light");
  if (reference.is_null()) return std::nullopt;
  const std::vector<tinygltf::Light>& lights = asset.model.lights;
  const auto index = reference.get<std::size_t>();
  if (index >= lights.size())
    throw IoError(asset.path,
                  fmt::format("nodes[{}]: expected a light below {}, found {}", node, lights.size(), index));
  const tinygltf::Light& from = lights[index];
  const std::string where = fmt::format("extensions.KHR_lights_punctual.lights[{}]", index);

  Light light;
  light.name = from.name.empty() ? asset.model.nodes[node].name : from.name;
  const auto scale = static_cast<float>(from.intensity / std::numbers::pi);
  if (from.color.size() == 3) {
    const auto channel = [&](std::size_t i) { return static_cast<float>(from.color[i]); };
    light.intensity = {channel(0), channel(1), channel(2)};
  }
  light.intensity = light.intensity * scale;
  light.position = glm::vec3(world[3]);
  light.decay = 2;
  light.range = static_cast<float>(from.range);
  if (from.type == "directional") {
    light.type = LightType::directional;
    light.direction_to_light = glm::vec3(direction_of(glm::dvec3(world[2]), asset, node));
  } else if (from.type == "point") {
    light.type = LightType::point;
  } else if (from.type == "spot") {
    light.type = LightType::spot;
    light.spot_direction = glm::vec3(direction_of(-glm::dvec3(world[2]), asset, node));
    light.inner_cone_rad = static_cast<float>(from.spot.innerConeAngle);
    light.outer_cone_rad = static_cast<float>(from.spot.outerConeAngle);
  } else {
    throw IoError(asset.path,
                  fmt::format("{}.type: expected \"directional\", \"point\" or \"spot\", found \"{}\"", where,
                              from.type));
  }
  try {
    check_light(light, where);
  } catch (const InvalidOption& error) {  // The number came from a file: its reading failed.
    throw IoError(asset.path, error.what());
  }
  return light;
}

std::optional<Camera> read_gltf_camera(const GltfAsset& asset, std::size_t node, const glm::dmat4& world) {
  const tinygltf::Node& holder = asset.model.nodes[node];
  if (holder.camera < 0) return std::nullopt;
  const tinygltf::Camera& from = asset.model.cameras[static_cast<std::size_t>(holder.camera)];
  Camera camera;
  camera.name = from.name.empty() ? holder.name : from.name;
  const auto expect_positive = [&](double number, const char* key) {
    if (!(number > 0) || !std::isfinite(number))
      throw IoError(asset.path, fmt::format("cameras[{}].{}: expected a number above 0, found {}",
                                            holder.camera, key, number));
    return static_cast<float>(number);
  };
  if (from.type == "perspective") {
    camera.vertical_fov_rad = expect_positive(from.perspective.yfov, "perspective.yfov");
    if (camera.vertical_fov_rad >= std::numbers::pi_v<float>)
      throw IoError(asset.path, fmt::format("cameras[{}].perspective.yfov: expected less than pi, found {}",
                                            holder.camera, from.perspective.yfov));
    camera.near_distance = expect_positive(from.perspective.znear, "perspective.znear");
    if (from.perspective.zfar != 0)
      camera.far_distance = expect_positive(from.perspective.zfar, "perspective.zfar");
  } else if (from.type == "orthographic") {
    camera.projection = Projection::orthographic;
    camera.half_height = expect_positive(std::abs(from.orthographic.ymag), "orthographic.ymag");
    camera.near_distance = static_cast<float>(std::max(0.0, from.orthographic.znear));
    camera.far_distance = expect_positive(from.orthographic.zfar, "orthographic.zfar");
  } else {
    throw IoError(asset.path,
                  fmt::format("cameras[{}].type: expected \"perspective\" or \"orthographic\", found \"{}\"",
                              holder.camera, from.type));
  }
  const glm::dvec3 back = direction_of(glm::dvec3(world[2]), asset, node);
  const glm::dvec3 right = direction_of(glm::cross(glm::dvec3(world[1]), back), asset, node);
  camera.world_from_camera =
      glm::mat4(glm::dmat4(glm::dvec4(right, 0), glm::dvec4(glm::cross(back, right), 0), glm::dvec4(back, 0),
                           glm::dvec4(glm::dvec3(world[3]), 1)));
  return camera;
}

}  // namespace lambake
