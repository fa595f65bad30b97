#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "lambake/scene/scene.h"

namespace lambake {

/// The texture's value at `uv` (of the mesh's set `texture.texcoord_set`, origin at the image's upper left):
/// linear RGB and opacity. Its transform is applied, then its wrap modes and its filter; there are no
/// mipmaps. (1,1,1,1) for an image without pixels; a coordinate that is not finite counts as 0.
glm::vec4 sample_texture(const Scene& scene, const Texture& texture, const glm::vec2& uv);

/// The texel in column i and row j of the plane that the wrap modes cover with the image, which has pixels.
glm::vec4 texel_of_plane(const Image& image, const Texture& texture, std::int64_t i, std::int64_t j);

}  // namespace lambake
