#pragma once

#include "lambake/core/finding.h"
#include "lambake/io/gltf/asset.h"
#include "lambake/scene/scene.h"

/// Materials of glTF, read as Lambertian; internal to io.
namespace lambake {

/// Fills the scene's materials (those of the file, in its order, then the default one,
/// which the caller takes away where no primitive needs it), and the textures and
/// images that they need; and the asset's `emissions`. Emission behind a black texture is none.
/// @throws IoError if an image that is needed is missing or does not decode.
void read_gltf_materials(GltfAsset& asset, Scene& scene, Findings& findings);

/// The emission that the file gives to one of the scene's materials, but for the texture; 0 if that is black.
LinearRgb emission_in_file(const GltfAsset& asset, std::size_t material);

/// Whether the file gives one of the scene's materials a texture of base colour, or of emission where it
/// emits, that the scene has not: it was left out.
bool has_unread_texture(const GltfAsset& asset, const Scene& scene, std::size_t material);

/// Whether a primitive has not the texture coordinates that a texture needs, of the base colour or of the
/// emission of its material.
bool lacks_texcoords(const tinygltf::Primitive& primitive, const Scene& scene, const Material& material);

/// Whether it has those of this texture.
bool has_texcoords(const tinygltf::Primitive& primitive, const Texture& texture);

}  // namespace lambake
