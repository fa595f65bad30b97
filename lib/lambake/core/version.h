#pragma once

#include <string>

namespace lambake {

/// "0.1.0".
std::string version();

/// How the library was built and what it runs on: build type, compiler, its flags, the vector path in use and
/// the others that could be, threads. A few lines "name: value", ending with a newline.
std::string build_info();

}  // namespace lambake
