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

std::uint32_t FileTextures::use(const std::string& name, const char* instead) {
  const auto [known, is_new] = known_.try_emplace(name, no_texture);
  if (is_new) known->second = add(name, instead);
  return known->second;
}

std::uint32_t FileTextures::add(const std::string& name, const char* instead) {
  file_.referred_files.push_back(path_beside(path_, name));
  Image image;
  try {
    image = read_image(file_.referred_files.back());
  } catch (const IoError& error) {
    add_finding(file_.findings, "unreadable_textures", 1,
                std::string("texture could not be read, ") + instead + " instead: " + error.what());
    return no_texture;
  }
  file_.images.push_back(std::move(image));
  Texture texture;
  texture.image = static_cast<std::uint32_t>(file_.images.size() - 1);
  file_.textures.push_back(texture);
  return static_cast<std::uint32_t>(file_.textures.size() - 1);
}

}  // namespace lambake
