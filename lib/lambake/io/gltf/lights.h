#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "lambake/io/gltf/asset.h"
#include "lambake/scene/camera.h"
#include "lambake/scene/light.h"

/// Lights and cameras of glTF; internal to io.
namespace lambake {

/// The light of KHR_lights_punctual that a node holds, placed by the node's world matrix; or none.
/// Lux and candela become the units of the equation: L = E/π, L = I/π.
/// @throws IoError if the light's numbers are not sound; InvalidScene if the matrix leaves no direction.
std::optional<Light> read_gltf_light(const GltfAsset& asset, std::size_t node, const glm::dmat4& world);

/// The camera that a node holds; or none. Scales of the node do not count.
/// @throws IoError, InvalidScene likewise.
std::optional<Camera> read_gltf_camera(const GltfAsset& asset, std::size_t node, const glm::dmat4& world);

}  // namespace lambake
