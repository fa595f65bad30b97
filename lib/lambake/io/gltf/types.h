#pragma once

#include <string>

#include "lambake/io/gltf/document.h"

namespace lambake {

/// Checks that the members which lambake reads have the types and lengths that glTF 2.0 and its extensions
/// give them: tinygltf takes the default in the place of an optional member of another type, and the lower 32
/// bits of a whole number. null counts as left out.
/// @throws IoError (path and place) at the first that has another.
void check_gltf_types(const std::string& path, const GltfJson& json);

}  // namespace lambake
