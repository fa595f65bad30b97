#pragma once

#include <string>

namespace lambake {

/// All bytes of a file that the user names: a regular one or a pipe. @throws IoError if it is missing, a
/// folder, a device, unreadable or empty.
std::string read_bytes(const std::string& path);

/// All bytes of a file that another file names: a regular one only, as anything else may never end.
std::string read_named_bytes(const std::string& path);

}  // namespace lambake
