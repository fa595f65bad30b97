#include "lambake/io/gltf/asset.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <exception>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "lambake/core/error.h"
#include "lambake/io/gltf/accessor.h"
#include "lambake/io/gltf/compression.h"
#include "lambake/io/gltf/source.h"
#include "lambake/io/json_text.h"

namespace lambake {
namespace {

constexpr std::string_view buffer_prefix = "lambake-buffer-";

/// What tinygltf reads from: the buffers that are in memory by made-up names, each of them once, and images
/// beside the file, which may have any name.
struct Files {
  std::vector<std::vector<unsigned char>> buffers;  ///< Empty once they are read.

  std::vector<unsigned char>* buffer(const std::string& name) {
    const std::string file = std::filesystem::path(name).filename().string();
    if (!file.starts_with(buffer_prefix)) return nullptr;
    std::size_t i = 0;
    const char* end = file.data() + file.size();
    const auto [stop, error] = std::from_chars(file.data() + buffer_prefix.size(), end, i);
    return error == std::errc() && stop == end && i < buffers.size() && !buffers[i].empty() ? &buffers[i]
                                                                                            : nullptr;
  }
};

bool file_exists(const std::string& name, void* user) {
  std::error_code ignored;
  return static_cast<Files*>(user)->buffer(name) != nullptr ||
         std::filesystem::is_regular_file(name, ignored);
}

bool read_whole_file(std::vector<unsigned char>* bytes, std::string* error, const std::string& name,
                     void* user) {
  if (std::vector<unsigned char>* buffer = static_cast<Files*>(user)->buffer(name)) {
    *bytes = std::exchange(*buffer, {});
    return true;
  }
  return tinygltf::ReadWholeFile(bytes, error, name, nullptr);
}

std::string same_path(const std::string& name, void*) {
  return name;
}

/// Keeps the encoded bytes: only images that a material needs are decoded, later.
bool keep_image(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes,
                int n_bytes, void*) {
  image->image.assign(bytes, bytes + n_bytes);
  image->as_is = true;
  return true;
}

/// A name as tinygltf decodes it, which takes + for a blank.
std::string encode_for_tinygltf(const std::string& name) {
  std::string uri;
  for (const char c : name)
    if (c == '+' || c == '%')
      uri += c == '+' ? "%2B" : "%25";
    else
      uri += c;
  return uri;
}

/// tinygltf wants a buffer view of indices. Without one they are zeros, but for sparse values.
void hide_indices_without_view(GltfJson& plain) {
  const GltfJson& accessors = member(plain, "accessors");
  if (!member(plain, "meshes").is_array()) return;
  for (GltfJson& mesh : plain["meshes"]) {
    if (!member(mesh, "primitives").is_array()) continue;
    for (GltfJson& primitive : mesh["primitives"])
      if (const GltfJson& index = member(primitive, "indices");
          index.is_number() && index < accessors.size() &&
          member(accessors[index.get<std::size_t>()], "bufferView").is_null())
        primitive.erase("indices");
  }
}

void restore_indices(const GltfJson& json, tinygltf::Model& model) {
  for (std::size_t m = 0; m < model.meshes.size(); ++m)
    for (std::size_t p = 0; p < model.meshes[m].primitives.size(); ++p)
      if (const GltfJson& index = member(json["meshes"][m]["primitives"][p], "indices"); index.is_number())
        model.meshes[m].primitives[p].indices = index.get<int>();
}

/// What it calls the bytes of an image, which join `buffers` if the URI holds them itself.
std::string uri_for_tinygltf(const std::string& uri, std::vector<std::vector<unsigned char>>& buffers) {
  if (!is_data_uri(uri)) return encode_for_tinygltf(decode_percent(uri));
  buffers.push_back(bytes_of_data_uri(uri).value_or(std::vector<unsigned char>()));
  return std::string(buffer_prefix) + std::to_string(buffers.size() - 1);
}

/// What tinygltf stumbles over though the specification allows it, or that it need not see.
void prepare(GltfJson& plain, std::vector<std::vector<unsigned char>>& buffers) {
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    if (buffers[i].empty()) buffers[i].resize(1);
    GltfJson& buffer = plain["buffers"][i];
    buffer["byteLength"] = buffers[i].size();
    buffer["uri"] = std::string(buffer_prefix) + std::to_string(i);
  }
  if (member(plain, "images").is_array())
    for (GltfJson& image : plain["images"])
      if (const GltfJson& uri = member(image, "uri"); uri.is_string())
        image["uri"] = uri_for_tinygltf(uri, buffers);
  hide_indices_without_view(plain);
  if (member(plain, "accessors").is_array())
    for (GltfJson& accessor : plain["accessors"])
      if (member(accessor, "sparse").is_object())
        for (const char* part : {"indices", "values"})
          if (member(accessor["sparse"], part).is_object() &&
              !accessor["sparse"][part].contains("byteOffset"))
            accessor["sparse"][part]["byteOffset"] = 0;
}

tinygltf::Model parse_model(const std::string& path, const GltfJson& plain,
                            std::vector<std::vector<unsigned char>> buffers) {
  Files files{std::move(buffers)};
  tinygltf::TinyGLTF loader;
  loader.SetFsCallbacks({file_exists, same_path, read_whole_file, nullptr, &files});
  loader.SetImageLoader(keep_image, nullptr);
  const std::string text = plain.dump();
  const std::string folder = std::filesystem::path(path).parent_path().string();
  tinygltf::Model model;
  std::string error, warning;
  bool is_loaded = false;
  try {
    is_loaded = loader.LoadASCIIFromString(&model, &error, &warning, text.data(),
                                           static_cast<unsigned int>(text.size()), folder);
  } catch (const std::exception& thrown) {
    error = thrown.what();
  }
  if (!is_loaded) {
    while (!error.empty() && error.back() == '\n') error.pop_back();
    for (char& c : error) c = c == '\n' ? ' ' : c;
    throw IoError(path, "not sound: " + (error.empty() ? "tinygltf gives no reason" : error));
  }
  return model;
}

/// Checks the numbers that name other objects, and the node trees.
class ModelCheck {
 public:
  ModelCheck(const std::string& path, const tinygltf::Model& model) : path_(path), model_(model) {}

  void run() {
    for (std::size_t m = 0; m < model_.meshes.size(); ++m)
      for (std::size_t p = 0; p < model_.meshes[m].primitives.size(); ++p)
        check_primitive(model_.meshes[m].primitives[p], fmt::format("meshes[{}].primitives[{}]", m, p));
    for (std::size_t n = 0; n < model_.nodes.size(); ++n)
      check_node(model_.nodes[n], fmt::format("nodes[{}]", n));
    for (std::size_t s = 0; s < model_.scenes.size(); ++s)
      for (const int root : model_.scenes[s].nodes)
        expect_index(root, model_.nodes.size(), fmt::format("scenes[{}].nodes", s));
    expect_optional(model_.defaultScene, model_.scenes.size(), "scene");
    for (std::size_t s = 0; s < model_.skins.size(); ++s) {
      const std::string where = fmt::format("skins[{}]", s);
      expect_optional(model_.skins[s].inverseBindMatrices, model_.accessors.size(),
                      where + ".inverseBindMatrices");
      for (const int joint : model_.skins[s].joints)
        expect_index(joint, model_.nodes.size(), where + ".joints");
    }
    for (std::size_t t = 0; t < model_.textures.size(); ++t)  // A source that is not there counts as none.
      expect_optional(model_.textures[t].sampler, model_.samplers.size(),
                      fmt::format("textures[{}].sampler", t));
    for (std::size_t m = 0; m < model_.materials.size(); ++m) {
      const tinygltf::Material& material = model_.materials[m];
      const std::string where = fmt::format("materials[{}]", m);
      expect_optional(material.pbrMetallicRoughness.baseColorTexture.index, model_.textures.size(),
                      where + ".pbrMetallicRoughness.baseColorTexture");
      expect_optional(material.emissiveTexture.index, model_.textures.size(), where + ".emissiveTexture");
    }
    check_trees();
  }

 private:
  void expect_index(int index, std::size_t size, const std::string& where) const {
    if (index < 0 || static_cast<std::size_t>(index) >= size)
      throw IoError(path_, fmt::format("{}: expected an index below {}, found {}", where, size, index));
  }
  void expect_optional(int index, std::size_t size, const std::string& where) const {
    if (index != -1) expect_index(index, size, where);
  }

  void check_primitive(const tinygltf::Primitive& primitive, const std::string& where) const {
    expect_optional(primitive.indices, model_.accessors.size(), where + ".indices");
    expect_optional(primitive.material, model_.materials.size(), where + ".material");
    check_attributes(primitive.attributes, primitive, where + ".");
    for (const auto& target : primitive.targets) check_attributes(target, primitive, where + ".targets.");
  }

  /// Each has as many elements as the positions.
  void check_attributes(const std::map<std::string, int>& attributes, const tinygltf::Primitive& primitive,
                        const std::string& where) const {
    for (const auto& [semantic, accessor] : attributes) {
      expect_index(accessor, model_.accessors.size(), where + semantic);
      const auto position = primitive.attributes.find("POSITION");
      if (position == primitive.attributes.end()) continue;
      expect_index(position->second, model_.accessors.size(), where + "POSITION");
      const std::size_t expected = model_.accessors[static_cast<std::size_t>(position->second)].count;
      const std::size_t found = model_.accessors[static_cast<std::size_t>(accessor)].count;
      if (found != expected)
        throw IoError(path_,
                      fmt::format("{}{}: expected {} elements, found {}", where, semantic, expected, found));
    }
  }

  void check_node(const tinygltf::Node& node, const std::string& where) const {
    expect_optional(node.mesh, model_.meshes.size(), where + ".mesh");
    expect_optional(node.skin, model_.skins.size(), where + ".skin");
    expect_optional(node.camera, model_.cameras.size(), where + ".camera");
    for (const int child : node.children) expect_index(child, model_.nodes.size(), where + ".children");
    expect_finite(node.matrix, where + ".matrix");
    expect_finite(node.translation, where + ".translation");
    expect_finite(node.rotation, where + ".rotation");
    expect_finite(node.scale, where + ".scale");
  }

  void expect_finite(const std::vector<double>& numbers, const std::string& where) const {
    for (const double number : numbers)
      if (!std::isfinite(static_cast<float>(number)))
        throw IoError(path_, fmt::format("{}: expected finite numbers, found {}", where, number));
  }

  /// Each node has at most one parent and is reached from a root.
  void check_trees() const {
    std::vector<int> parents(model_.nodes.size(), -1);
    for (std::size_t n = 0; n < model_.nodes.size(); ++n)
      for (const int child : model_.nodes[n].children) {
        int& parent = parents[static_cast<std::size_t>(child)];
        if (parent != -1)
          throw IoError(path_, fmt::format("nodes[{}]: expected one parent, found nodes[{}] and nodes[{}]",
                                           child, parent, n));
        parent = static_cast<int>(n);
      }
    std::vector<int> open;
    for (std::size_t n = 0; n < parents.size(); ++n)
      if (parents[n] == -1) open.push_back(static_cast<int>(n));
    std::size_t n_reached = 0;
    for (; !open.empty(); ++n_reached) {
      const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(open.back())];
      open.pop_back();
      open.insert(open.end(), node.children.begin(), node.children.end());
    }
    if (n_reached != parents.size())
      throw IoError(path_, fmt::format("nodes: expected trees, found a cycle of {} nodes or fewer",
                                       parents.size() - n_reached));
  }

  const std::string& path_;
  const tinygltf::Model& model_;
};

/// Materials of variants are not in the model.
void check_variants(const std::string& path, const GltfJson& json) {
  const std::size_t n_materials = member(json, "materials").size();
  for (std::size_t m = 0; m < member(json, "meshes").size(); ++m) {
    const GltfJson& primitives = member(json["meshes"][m], "primitives");
    for (std::size_t p = 0; p < primitives.size(); ++p)
      for (const GltfJson* holder : material_holders(primitives[p]))
        if (const GltfJson& material = member(*holder, "material");
            !material.is_null() && material.get<std::size_t>() >= n_materials)
          throw IoError(path,
                        fmt::format("meshes[{}].primitives[{}].extensions.KHR_materials_variants: expected "
                                    "materials below {}, found {}",
                                    m, p, n_materials, shown(material)));
  }
}

}  // namespace

GltfAsset load_gltf_asset(const std::string& path) {
  GltfSource source = read_gltf_source(path);
  GltfAsset asset;
  asset.path = path;
  asset.is_glb = source.is_glb;
  asset.n_unknown_chunks = source.n_unknown_chunks;
  asset.n_file_buffers = source.buffers.size();
  GltfJson plain = source.json;
  std::vector<std::vector<unsigned char>> buffers = std::move(source.buffers);
  decompress(source, plain, buffers);
  prepare(plain, buffers);
  asset.model = parse_model(path, plain, std::move(buffers));
  asset.json = std::move(source.json);
  restore_indices(asset.json, asset.model);
  check_accessors(path, asset.model);
  ModelCheck(path, asset.model).run();
  check_variants(path, asset.json);
  return asset;
}

}  // namespace lambake
