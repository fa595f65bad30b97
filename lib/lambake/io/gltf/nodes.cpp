#include "lambake/io/gltf/nodes.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <optional>

#include "lambake/core/error.h"

namespace lambake {
namespace {

glm::dmat4 local_matrix(const tinygltf::Node& node) {
  glm::dmat4 m(1);
  if (node.matrix.size() == 16) {
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node.matrix[index_of(i)];
    return m;
  }
  if (node.rotation.size() == 4) {
    const glm::dquat q(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
    if (glm::length(q) > 0) m = glm::mat4_cast(glm::normalize(q));
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (node.scale.size() == 3) m[axis] *= node.scale[index_of(axis)];
    if (node.translation.size() == 3) m[3][axis] = node.translation[index_of(axis)];
  }
  return m;
}

std::vector<std::size_t> roots_of_file(const GltfAsset& asset) {
  const std::vector<tinygltf::Node>& nodes = asset.model.nodes;
  std::vector<bool> is_child(nodes.size(), false);
  for (const tinygltf::Node& node : nodes)
    for (const int child : node.children) is_child[index_of(child)] = true;
  std::vector<std::size_t> roots;
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (!is_child[n]) roots.push_back(n);
  return roots;
}

/// The nodes below `roots`, parents first, in the order of the file.
std::vector<std::size_t> walk(const GltfAsset& asset, std::vector<std::size_t> roots) {
  std::vector<std::size_t> order, open(roots.rbegin(), roots.rend());
  std::vector<bool> is_met(asset.model.nodes.size(), false);
  while (!open.empty()) {
    const std::size_t n = open.back();
    open.pop_back();
    if (is_met[n])
      throw IoError(asset.path, fmt::format("nodes[{}]: expected once in the scene, found again", n));
    is_met[n] = true;
    order.push_back(n);
    const std::vector<int>& children = asset.model.nodes[n].children;
    for (auto child = children.rbegin(); child != children.rend(); ++child) open.push_back(index_of(*child));
  }
  return order;
}

std::optional<std::size_t> find_scene(const GltfAsset& asset, const std::string& choice) {
  const std::vector<tinygltf::Scene>& scenes = asset.model.scenes;
  if (choice.empty()) {
    if (scenes.empty()) return std::nullopt;
    return asset.model.defaultScene < 0 ? 0 : index_of(asset.model.defaultScene);
  }
  for (std::size_t s = 0; s < scenes.size(); ++s)
    if (scenes[s].name == choice) return s;
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(choice.data(), choice.data() + choice.size(), number);
  if (error == std::errc() && end == choice.data() + choice.size() && number < scenes.size()) return number;
  throw InvalidOption(
      fmt::format("{}: expected the name or the number of a scene, of which it has {}, found \"{}\"",
                  asset.path, scenes.size(), choice));
}

}  // namespace

std::vector<glm::dmat4> world_matrices(const GltfAsset& asset) {
  const std::vector<tinygltf::Node>& nodes = asset.model.nodes;
  std::vector<glm::dmat4> world(nodes.size(), glm::dmat4(1));
  for (const std::size_t n : walk(asset, roots_of_file(asset))) {
    world[n] = world[n] * local_matrix(nodes[n]);  // The parent's matrix lies there already.
    for (int i = 0; i < 16; ++i)
      if (!std::isfinite(static_cast<float>(world[n][i / 4][i % 4])))
        throw InvalidScene(fmt::format("{}: nodes[{}]: its world matrix is not finite", asset.path, n));
    for (const int child : nodes[n].children) world[index_of(child)] = world[n];
  }
  return world;
}

std::vector<std::size_t> nodes_of_scene(const GltfAsset& asset, const std::string& choice) {
  const std::optional<std::size_t> scene = find_scene(asset, choice);
  if (!scene) return walk(asset, roots_of_file(asset));
  std::vector<std::size_t> roots;
  for (const int root : asset.model.scenes[*scene].nodes) roots.push_back(index_of(root));
  return walk(asset, std::move(roots));
}

}  // namespace lambake
