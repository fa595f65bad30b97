#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "lambake/io/gltf/asset.h"

/// Vertices and triangles of a placed primitive, in world space; internal to io.
namespace lambake {

bool has_triangles(const tinygltf::Primitive& primitive);

/// The triangles of a primitive: list, strip or fan, indexed or not. Degenerate ones of a strip stay.
/// @throws IoError if an index is not below `n_vertices`.
std::vector<glm::uvec3> read_triangles(const GltfAsset& asset, const tinygltf::Primitive& primitive,
                                       std::size_t n_vertices, const std::string& where);

/// Chooses the vertices that are read of a primitive that shares its accessors with others: those that its
/// triangles use, in the order in which they meet them, or all where that is half of them or more. So the
/// primitives take memory for what they use, not for the accessors each.
class VertexSelector {
 public:
  /// @param triangles  of accessor vertices below `n_vertices`; of selected ones afterwards.
  VertexSelection select(std::vector<glm::uvec3>& triangles, std::size_t n_vertices);

 private:
  std::vector<std::uint32_t> number_of_;  ///< Scratch: number of an accessor's vertex among the selected.
};

struct WorldVertices {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;  ///< Unit vectors or (0,0,0); none where the primitive has none.
  bool is_mirrored = false;        ///< The winding turns.
  double cut_rounding = 0;         ///< CutRounding::distance.
};

/// Vertices of a node's primitive in the pose of the file: morphed, skinned, placed. Normals go through the
/// inverse transpose.
/// @param selection  the vertices wanted.
/// @param world      of all nodes.
WorldVertices read_vertices(const GltfAsset& asset, std::size_t node, const tinygltf::Primitive& primitive,
                            const VertexSelection& selection, const std::vector<glm::dmat4>& world,
                            const std::string& where);

/// Values of a primitive's attribute with `n_components` for each of the vertices wanted, the displacements
/// of morph targets added by the weights of the node or else of its mesh; not clamped. Empty where there is
/// none.
/// @throws IoError if the accessor has another type or count.
std::vector<float> read_morphed(const GltfAsset& asset, const tinygltf::Node& node,
                                const tinygltf::Primitive& primitive, const std::string& semantic,
                                std::size_t n_components, const VertexSelection& selection,
                                const std::string& where);

}  // namespace lambake
