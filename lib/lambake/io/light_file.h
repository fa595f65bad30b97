#pragma once

#include <string>
#include <vector>

#include "lambake/scene/light.h"

namespace lambake {

/// Reads a lights file (docs/lights.schema.json). Unknown keys are errors.
/// @throws IoError with the place in the document.
std::vector<Light> read_light_file(const std::string& path);

}  // namespace lambake
