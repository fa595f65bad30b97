#include "lambake/io/scene_file.h"

#include "lambake/io/file_extension.h"
#include "lambake/io/gltf.h"
#include "lambake/io/mesh_file.h"

namespace lambake {

SceneFile read_scene_file(const std::string& path, const ReadOptions& options) {
  const std::string extension = file_extension(path);
  if (extension == "gltf" || extension == "glb") return read_gltf_file(path, options);
  return read_mesh_file(path);
}

}  // namespace lambake
