#pragma once

#include <string>

#include "lambake/io/gltf.h"
#include "lambake/scene/material.h"

/// The two ways a glTF file is made, and what they share; internal to io.
namespace lambake {

/// A new asset with the arrays of the mesh that carries the colours.
WrittenColors write_new_gltf(const std::string& path, const Scene& scene, const BakedColors& baked,
                             const GltfWriteOptions& options);

/// The asset as it was read, with its light added. `baked` is of `scene`, which was read with the asset.
WrittenColors write_gltf_asset(const std::string& path, const GltfAsset& asset, const Scene& scene,
                               const BakedColors& baked, const GltfWriteOptions& options);

/// Whether an unlit material can show the emission as a part of its vertex colours: base ⊗ c = base ⊗ E + Le
/// needs a base colour that is the same all over the surface and nowhere 0 where there is emission.
bool can_fold_emission(const Material& material);

inline bool has_emission(const Material& material) {
  return !(material.emission == LinearRgb{0, 0, 0});
}

/// Findings about what the storage of the colours could not hold.
void tell_storage(Findings& findings, std::size_t clipped, std::size_t negative);

}  // namespace lambake
