#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "lambake/io/gltf/asset.h"

/// Node trees of glTF, walked without recursion; internal to io.
namespace lambake {

/// World matrices of all nodes of the file.
/// @throws InvalidScene if one is not finite as float.
std::vector<glm::dmat4> world_matrices(const GltfAsset& asset);

/// The scene by name or number; the file's default where `choice` is empty; all trees where the file has no
/// scene. Its nodes, parents before children, in the order of the file.
/// @throws InvalidOption if there is no such scene.
std::vector<std::size_t> nodes_of_scene(const GltfAsset& asset, const std::string& choice);

}  // namespace lambake
