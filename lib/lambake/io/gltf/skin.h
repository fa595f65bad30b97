#pragma once

#include <cstddef>
#include <vector>

#include "lambake/io/gltf/asset.h"
#include "lambake/io/gltf/rewrite.h"

/// Joints and weights of vertices that cuts made; internal to io.
namespace lambake {

/// One set of four joints and weights for each of n vertices, as an accessor holds them.
struct SkinSet {
  std::vector<unsigned char> joints, weights;
};

struct MixedSkin {
  std::vector<SkinSet> sets;  ///< In the place of JOINTS_k and WEIGHTS_k.
  int joint_type = gltf::unsigned_byte, weight_type = gltf::float_;
  std::size_t n_cut_short = 0;  ///< Vertices that have more joints than places: the weakest are left out.
};

/// The sets JOINTS_k, WEIGHTS_k, from 0 on, of the vertices of a primitive. Those of the file keep theirs; a
/// cut has the joints of all vertices that it lies between, with (1 − t)·w_a + t·w_b, as many of the heaviest
/// as there are places, made to sum to 1 (integers: to their largest exactly). So every pose moves it by the
/// mean of their matrices, the same one for both triangles at an edge.
/// @returns no sets where the primitive has none of four components for each vertex.
MixedSkin mix_skin(const GltfAsset& asset, const GltfJson& primitive, const BakedPrimitive& baked);

}  // namespace lambake
