#pragma once

#include <string>

#include "lambake/io/gltf.h"

/// The two ways a glTF file is made, and what they share; internal to io.
namespace lambake {

/// A new asset with the arrays of the mesh that carries the colours, a node for each object of the file.
WrittenColors write_new_gltf(const std::string& path, const SceneFile& file, const BakedColors& baked,
                             const GltfWriteOptions& options);

/// The asset as it was read, with its light added. `baked` is of `scene`, which was read with the asset.
WrittenColors write_gltf_asset(const std::string& path, const GltfAsset& asset, const Scene& scene,
                               const BakedColors& baked, const GltfWriteOptions& options);

/// What a certificate has to know of both.
ColorOutput new_gltf_output(const Scene& scene, const GltfWriteOptions& options);
ColorOutput gltf_asset_output(const GltfAsset& asset, const Scene& scene, const GltfWriteOptions& options);

}  // namespace lambake
