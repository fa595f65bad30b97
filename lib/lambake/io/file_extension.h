#pragma once

#include <cctype>
#include <filesystem>
#include <string>

namespace lambake {

/// The extension of a path without its dot, in lower case.
inline std::string file_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

}  // namespace lambake
