#pragma once

#include <cstdint>
#include <string>

#include "lambake/io/canonical_file.h"

namespace lambake {

/// Reads the image `name` that the mesh file `path` refers to, and returns the index of its texture in
/// `file`. An image that cannot be read is a finding, and the texture none. Each name is read once.
std::uint32_t add_file_texture(const std::string& path, const std::string& name, CanonicalFile& file);

/// The path of a file that `path` refers to by `name`: beside it, unless the name is absolute.
std::string path_beside(const std::string& path, const std::string& name);

}  // namespace lambake
