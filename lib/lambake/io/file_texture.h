#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "lambake/io/canonical_file.h"

namespace lambake {

/// The textures that a mesh file refers to by the names of their images.
class FileTextures {
 public:
  /// @param path  of the mesh file. @param file  gets textures, images and findings.
  FileTextures(const std::string& path, CanonicalFile& file) : path_(path), file_(file) {}

  /// The index of the image's texture in the file. An image that cannot be read is a finding, and the texture
  /// none. Each name is read once. @param instead  what the finding says that there is then.
  std::uint32_t use(const std::string& name, const char* instead = "white");

 private:
  std::uint32_t add(const std::string& name, const char* instead);

  const std::string& path_;
  CanonicalFile& file_;
  std::map<std::string, std::uint32_t> known_;
};

/// The path of a file that `path` refers to by `name`: beside it, unless the name is absolute.
std::string path_beside(const std::string& path, const std::string& name);

}  // namespace lambake
