#include "lambake/core/error.h"
#include "lambake/io/gltf.h"

namespace lambake {

SceneFile read_gltf_file(const std::string& path, const ReadOptions&) {
  throw IoError(path, "glTF is not read yet");
}

}  // namespace lambake
