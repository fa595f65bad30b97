#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "lambake/bake/bake.h"
#include "lambake/io/gltf/asset.h"

/// Primitives whose vertices became others by baking (split, or cut); internal to io.
namespace lambake {

/// What a vertex is made from: a vertex of the primitive's accessors, or a point between two earlier ones.
struct VertexOrigin {
  bool is_cut = false;
  std::uint32_t a = 0;  ///< Accessor vertex, or an earlier origin.
  std::uint32_t b = 0;  ///< Cuts: the other origin.
  float t = 0;          ///< Cuts: (1 − t)·a + t·b.
};

/// A placed primitive after baking.
struct BakedPrimitive {
  /// For each of its n vertices the vertex of the mesh that carries the colours, or no_vertex.
  std::vector<std::uint32_t> mesh_vertices;
  /// Whether its vertices are other than those of the file's accessors. What follows is for that case.
  bool is_rewritten = false;
  std::vector<VertexOrigin> origins;    ///< Each after those that it is made from.
  std::vector<std::uint32_t> vertices;  ///< n indices into `origins`.
  std::vector<glm::uvec3> triangles;    ///< Of the n vertices, wound as in the file.
};

inline constexpr std::uint32_t no_vertex = std::numeric_limits<std::uint32_t>::max();

/// Finds for each placed primitive what baking made of it. Where all copies of an accessor's vertex got one
/// colour and the triangles are the file's, the accessors stay as they are.
std::vector<BakedPrimitive> baked_primitives(const GltfAsset& asset, const Scene& scene,
                                             const BakedColors& baked);

/// Gives primitives new accessors. Equal data of several primitives is written once.
class PrimitiveRewriter {
 public:
  PrimitiveRewriter(const GltfAsset& asset, GltfDocument& document) : asset_(asset), document_(document) {}

  /// Replaces the primitive's attributes and morph targets, all but `skipped`, and indices; nothing of it is
  /// compressed afterwards. Floating point attributes are interpolated where a vertex is a cut, normals and
  /// tangents renormalised, joints and weights mixed (skin.h); whole numbers are those of the nearer
  /// end.
  void rewrite(GltfJson& primitive, const BakedPrimitive& baked, const std::string& skipped);

  /// Vertices of skinned primitives that had to leave out joints.
  std::size_t n_cut_short() const { return n_cut_short_; }

 private:
  /// @returns the attributes that it has written.
  std::set<std::string> rewrite_skin(GltfJson& primitive, const BakedPrimitive& baked);
  std::size_t rewrite_accessor(std::size_t accessor, const std::string& semantic, const BakedPrimitive& baked,
                               bool is_target);
  /// Gives accessor `to` what people wrote into the file's accessor `from`, unless it has some. @returns to.
  std::size_t keep_names(std::size_t from, std::size_t to);
  std::size_t append_once(const GltfElements& elements, const std::string& semantic);

  const GltfAsset& asset_;
  GltfDocument& document_;
  std::multimap<std::size_t, std::size_t> accessor_of_hash_;
  std::size_t n_cut_short_ = 0;
};

}  // namespace lambake
