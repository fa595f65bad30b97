#include "lambake/io/file_texture.h"

#include <algorithm>
#include <filesystem>

#include "lambake/core/error.h"
#include "lambake/io/image_file.h"

namespace lambake {

std::string path_beside(const std::string& path, const std::string& name) {
  std::string slashed = name;
  std::replace(slashed.begin(), slashed.end(), '\\', '/');
  return (std::filesystem::path(path).parent_path() / slashed).string();
}

std::uint32_t add_file_texture(const std::string& path, const std::string& name, CanonicalFile& file) {
  Image image;
  try {
    image = read_image(path_beside(path, name));
  } catch (const IoError& error) {
    add_finding(file.findings, "unreadable_textures", 1,
                std::string("texture could not be read, white instead: ") + error.what());
    return no_texture;
  }
  file.images.push_back(std::move(image));
  Texture texture;
  texture.image = static_cast<std::uint32_t>(file.images.size() - 1);
  file.textures.push_back(texture);
  return static_cast<std::uint32_t>(file.textures.size() - 1);
}

}  // namespace lambake
