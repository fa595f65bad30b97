#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

/// The JSON of a glTF file beside the bytes of its one buffer, and how both become a file; internal to io.
///
/// Keys keep their order, and what is not understood stays: that is why assets are written from their own
/// document and not through a model of known fields.
namespace lambake {

using GltfJson = nlohmann::ordered_json;

namespace gltf {
inline constexpr int byte = 5120, unsigned_byte = 5121, short_ = 5122, unsigned_short = 5123,
                     unsigned_int = 5125, float_ = 5126;
inline constexpr int array_buffer = 34962, element_array_buffer = 34963;
constexpr bool is_unsigned(int component_type) {
  return component_type == unsigned_byte || component_type == unsigned_short ||
         component_type == unsigned_int;
}
inline constexpr const char *draco = "KHR_draco_mesh_compression", *meshopt = "EXT_meshopt_compression",
                            *instancing = "EXT_mesh_gpu_instancing", *texture_webp = "EXT_texture_webp",
                            *unlit = "KHR_materials_unlit";
}  // namespace gltf

/// A number of tinygltf's that has been checked.
inline std::size_t index_of(int i) {
  return static_cast<std::size_t>(i);
}

/// Values as they lie in memory.
template <typename T>
std::span<const unsigned char> bytes_of(std::span<const T> values) {
  return {reinterpret_cast<const unsigned char*>(values.data()), values.size_bytes()};
}

/// Bytes that are not copied: they have to outlive the document.
struct LentBytes {
  std::span<const unsigned char> bytes;
  std::size_t begin = 0;  ///< In `buffers[0]`; a multiple of 4.
};

struct GltfDocument {
  GltfJson json = GltfJson::object();
  std::vector<LentBytes> lent;  ///< The first bytes of `buffers[0]`; see lend().
  /// The bytes of `buffers[0]` behind those, where the document has data of its own.
  std::vector<unsigned char> bin;
};

/// Where `bin` begins in `buffers[0]`, or where bytes would that are lent next.
std::size_t bin_offset(const GltfDocument& document);

/// Adds to `lent`.
void lend(GltfDocument& document, std::span<const unsigned char> bytes);

/// Elements to be added: `count` of them, `bytes.size() / count` apart (a multiple of 4 for attributes).
struct GltfElements {
  std::span<const unsigned char> bytes = {};
  std::size_t count = 0;
  int component_type = gltf::float_;
  const char* type = "VEC3";
  bool is_normalized = false;
  int target = gltf::array_buffer;  ///< 0: none.
  bool is_strided = false;          ///< The elements are padded: the view says its stride.
  bool is_lent = false;             ///< The bytes outlive the document: they are not copied.
};

/// Triangles as indices: of 16 bits where the vertices allow it, else of 32, which are the triangles' own
/// bytes.
class IndexElements {
 public:
  /// @param triangles  have to outlive the elements.
  IndexElements(std::span<const glm::uvec3> triangles, std::size_t n_vertices);
  GltfElements elements() const;

 private:
  std::span<const glm::uvec3> triangles_;
  std::vector<std::uint16_t> short_;  ///< 3 F, or none.
};

/// Appends bytes, 4-aligned, with a buffer view; returns the view's index. Once bytes are lent, all have to
/// be.
std::size_t append_view(GltfDocument& document, std::span<const unsigned char> bytes, int target,
                        std::size_t stride, bool is_lent = false);

/// Appends elements with their view and accessor; returns the accessor's index.
std::size_t append_accessor(GltfDocument& document, const GltfElements& elements);

/// Appends `value` to the top-level array `key`, which is made if there is none; returns its index.
std::size_t append_to(GltfJson& json, const char* key, GltfJson value);

/// Adds a name to `extensionsUsed` unless it is there.
void use_extension(GltfJson& json, const char* name);

/// Throws IoError where a GLB cannot hold `n_bin_bytes` beside `n_json_bytes`: its lengths are of 32 bits.
void check_glb_size(const std::string& path, std::uint64_t n_json_bytes, std::uint64_t n_bin_bytes);

/// How many vertices the primitives of the meshes have, one that several of them share once.
std::size_t count_vertices(const GltfJson& document);

/// Writes the document, whole or not at all: as GLB, or as JSON with a .bin beside it, by the extension of
/// `path`. `buffers[0]` is made to fit `bin`.
/// @throws IoError if the file cannot be written or is a GLB past 4 GiB; InvalidOption for another extension.
void write_document(const std::string& path, GltfDocument& document);

}  // namespace lambake
