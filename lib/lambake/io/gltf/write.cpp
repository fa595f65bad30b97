#include "lambake/io/gltf/write.h"

#include "lambake/core/error.h"

namespace lambake {

void check_gltf_write_options(const GltfWriteOptions& options) {
  if (options.attribute != "COLOR_0" && !options.attribute.starts_with("_"))
    throw InvalidOption("attribute: expected COLOR_0 or a name that begins with _, found " +
                        options.attribute);
}

WrittenColors write_gltf_file(const std::string& path, const SceneFile& file, const BakedColors& baked,
                              const GltfWriteOptions& options) {
  check_gltf_write_options(options);
  if (file.asset) return write_gltf_asset(path, *file.asset, file.scene, baked, options);
  return write_new_gltf(path, file, baked, options);
}

ColorOutput gltf_output(const SceneFile& file, const GltfWriteOptions& options) {
  return file.asset ? gltf_asset_output(*file.asset, file.scene, options)
                    : new_gltf_output(file.scene, options);
}

}  // namespace lambake
