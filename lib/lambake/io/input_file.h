#pragma once

#include <string>

namespace lambake {

/// All bytes of a file. @throws IoError if it is missing, a folder, unreadable or empty.
std::string read_bytes(const std::string& path);

}  // namespace lambake
