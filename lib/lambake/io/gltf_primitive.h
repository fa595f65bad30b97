#pragma once

#include <glm/glm.hpp>
#include <map>
#include <string>
#include <vector>

#include "lambake/io/gltf_asset.h"

/// Vertices and triangles of a placed primitive, in world space; internal to io.
namespace lambake {

bool has_triangles(const tinygltf::Primitive& primitive);

/// The triangles of a primitive: list, strip or fan, indexed or not. Degenerate ones of a strip stay.
/// @throws IoError if an index is not below `n_vertices`.
std::vector<glm::uvec3> read_triangles(const GltfAsset& asset, const tinygltf::Primitive& primitive,
                                       std::size_t n_vertices, const std::string& where);

struct WorldVertices {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;  ///< Unit vectors or (0,0,0); none where the primitive has none.
  bool is_mirrored = false;        ///< The winding turns.
};

/// Vertices of a node's primitive in the pose of the file: morphed, skinned, placed. Normals go through the
/// inverse transpose.
/// @param world  of all nodes.
WorldVertices read_vertices(const GltfAsset& asset, std::size_t node, const tinygltf::Primitive& primitive,
                            const std::vector<glm::dmat4>& world, const std::string& where);

/// Values of an attribute with `n_components` for each of `n_vertices`; empty where there is none.
/// @throws IoError if the accessor has another type or count.
std::vector<float> read_attribute(const GltfAsset& asset, const std::map<std::string, int>& attributes,
                                  const std::string& semantic, std::size_t n_components,
                                  std::size_t n_vertices, const std::string& where);

}  // namespace lambake
