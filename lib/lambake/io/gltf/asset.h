#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <string>
#include <vector>

#include "lambake/core/color.h"
#include "lambake/io/gltf/document.h"
#include "lambake/io/scene_file.h"

/// The glTF file behind a scene; internal to io.
namespace lambake {

/// The vertices of a primitive's accessors that are read.
struct VertexSelection {
  std::size_t n_accessor = 0;  ///< Elements of each accessor.
  /// The accessors' vertex of each that is read, or none: all of them.
  std::vector<std::uint32_t> selected{};

  std::size_t size() const { return selected.empty() ? n_accessor : selected.size(); }
  std::uint32_t accessor_vertex(std::uint32_t i) const { return selected.empty() ? i : selected[i]; }
};

/// A primitive of triangles under a node: where it went in the scene's mesh.
struct PlacedPrimitive {
  std::size_t node = 0, mesh = 0, primitive = 0;
  VertexSelection vertices;
  std::uint32_t vertex_begin = 0;  ///< In the mesh as read: first the selected vertices, then flat copies.
  std::uint32_t source_begin = 0;  ///< Mesh::source_vertices of selected vertex i is source_begin + i.
  std::uint32_t triangle_begin = 0, triangle_end = 0;
  bool is_mirrored = false;  ///< Its triangles are wound the other way than in the file.
};

struct GltfAsset {
  std::string path;
  bool is_glb = false;
  std::size_t n_unknown_chunks = 0;  ///< Of a GLB, beside the two that are known.
  GltfJson json;                     ///< As the file has it.
  tinygltf::Model model;  ///< Nothing compressed, everything checked; images hold their encoded bytes.
  std::size_t n_file_buffers = 0;  ///< The first of `model.buffers` are the file's own (fallbacks: 1 byte).
  std::vector<PlacedPrimitive> placed;  ///< In the order of the mesh.
  /// Of each material of the file, but for its texture; 0 where that is black.
  std::vector<LinearRgb> emissions;
};

/// Reads and checks a file: every buffer view lies in its buffer, every accessor in its view, every index
/// names something that there is, and the nodes are trees.
/// @throws IoError.
GltfAsset load_gltf_asset(const std::string& path);

}  // namespace lambake
