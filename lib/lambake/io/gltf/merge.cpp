#include "lambake/io/gltf/merge.h"

#include "lambake/io/gltf/source.h"
#include "lambake/io/image_file.h"

namespace lambake {
namespace {

/// Views may hold any component type: buffers begin at multiples of 8.
void align(GltfDocument& document) {
  static constexpr unsigned char zeros[4] = {};
  if (bin_offset(document) % 8 != 0) lend(document, zeros);
}

/// Where the bytes of each buffer went.
struct Moved {
  std::size_t buffer = 0, offset = 0;
};

void move(GltfJson& holder, const std::vector<Moved>& moved) {
  const Moved& to = moved[holder["buffer"].get<std::size_t>()];
  holder["buffer"] = to.buffer;
  if (to.offset == 0) return;
  const GltfJson& offset = member(holder, "byteOffset");
  holder["byteOffset"] = to.offset + (offset.is_null() ? 0 : offset.get<std::size_t>());
}

void embed_images(const GltfAsset& asset, GltfDocument& document, Findings& findings) {
  std::size_t n_missing = 0;
  for (std::size_t i = 0; i < asset.model.images.size(); ++i) {
    GltfJson& image = document.json["images"][i];
    const GltfJson& uri = member(image, "uri");
    if (uri.is_null()) continue;
    const std::vector<unsigned char>& bytes = asset.model.images[i].image;
    const std::string mime_type = mime_type_of({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    if (mime_type.empty()) {
      ++n_missing;
      continue;
    }
    image.erase("uri");
    image["mimeType"] = mime_type;
    image["bufferView"] = append_view(document, bytes, 0, 0);
  }
  add_finding(
      findings, "images_not_embedded", n_missing,
      "image[ is|s are] missing or neither PNG, JPEG nor WebP; the written file names [it|them] where the "
      "input did");
}

}  // namespace

void merge_buffers(const GltfAsset& asset, GltfDocument& document, Findings& findings) {
  GltfJson& json = document.json;
  std::vector<Moved> moved(asset.n_file_buffers);
  GltfJson first, rest = GltfJson::array();
  for (std::size_t i = 0; i < asset.n_file_buffers; ++i) {
    GltfJson buffer = json["buffers"][i];
    const bool has_bytes = member(member(buffer, "extensions"), gltf::meshopt).is_null() ||
                           buffer.contains("uri") || (i == 0 && asset.is_glb);
    if (!has_bytes) {
      rest.push_back(std::move(buffer));
      moved[i].buffer = rest.size();
      continue;
    }
    const std::vector<unsigned char>& bytes = asset.model.buffers[i].data;
    align(document);
    moved[i].offset = bin_offset(document);
    lend(document, bytes);
    buffer.erase("uri");
    if (first.is_null()) first = std::move(buffer);
  }
  if (asset.n_file_buffers > 0) {
    json["buffers"] = GltfJson::array({first.is_null() ? GltfJson::object() : first});
    for (GltfJson& buffer : rest) json["buffers"].push_back(std::move(buffer));
    if (json.contains("bufferViews"))
      for (GltfJson& view : json["bufferViews"]) {
        move(view, moved);
        if (!member(member(view, "extensions"), gltf::meshopt).is_null())
          move(view["extensions"][gltf::meshopt], moved);
      }
  }
  embed_images(asset, document, findings);
}

}  // namespace lambake
