#pragma once

#include <filesystem>
#include <string>
#include <utility>

namespace lambake {

/// ASCII letters as small ones; all else as it is.
inline std::string in_lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

/// The extension of a path without its dot, in lower case.
inline std::string file_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  return in_lower_case(std::move(extension));
}

}  // namespace lambake
