#pragma once

#include <span>
#include <string>

#include "lambake/io/gltf/document.h"

namespace lambake {

/// Parses the JSON of a glTF file. Of equal keys in an object the last counts. Time O(n log n), where
/// GltfJson::parse() looks for each key among all before it.
/// @throws IoError if the text is no JSON, or nested deeper than 256 levels.
GltfJson parse_gltf_json(std::span<const unsigned char> text, const std::string& path);

}  // namespace lambake
