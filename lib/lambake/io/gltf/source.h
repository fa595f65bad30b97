#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lambake/io/gltf/document.h"

/// A glTF file taken apart, before its meaning is looked at; internal to io.
namespace lambake {

struct GltfSource {
  std::string path;
  bool is_glb = false;
  std::size_t n_unknown_chunks = 0;  ///< Of a GLB, beside the two that are known.
  GltfJson json;                     ///< As the file has it.
  /// The bytes of each buffer: `byteLength` of them. Fallback buffers of EXT_meshopt_compression, which have
  /// no bytes of their own, are empty.
  std::vector<std::vector<unsigned char>> buffers;
};

/// Reads the container, the JSON and all buffers.
/// @throws IoError if the container's lengths do not fit the file, the JSON is none or nested deeper than 256
///         levels, a member has another type than glTF gives it, a buffer is missing or shorter than it says,
///         or an extension is required that is unknown.
GltfSource read_gltf_source(const std::string& path);

/// The file that a relative URI names, beside `path`.
std::filesystem::path file_beside(const std::string& path, const std::string& uri);

/// A URI's text with %XX replaced by what it stands for; all else is literal, + too (RFC 3986).
std::string decode_percent(const std::string& uri);

/// Whether a URI holds its bytes itself: data:, in any case (RFC 2397).
bool is_data_uri(const std::string& uri);

/// The bytes of such a URI, as base64 or as text with %XX; none if they are neither.
std::optional<std::vector<unsigned char>> bytes_of_data_uri(const std::string& uri);

/// Extensions whose meaning for Lambert light is taken in, or that have none.
bool is_known_extension(const std::string& name);

/// The member `key` of an object, or null where there is none or `json` is no object.
const GltfJson& member(const GltfJson& json, const char* key);

/// What names a material of a primitive: itself, and the mappings of its KHR_materials_variants.
/// @tparam Json  GltfJson, const or not.
template <typename Json>
std::vector<Json*> material_holders(Json& primitive) {
  constexpr const char* variants = "KHR_materials_variants";
  std::vector<Json*> holders{&primitive};
  if (member(member(member(primitive, "extensions"), variants), "mappings").is_array())
    for (Json& mapping : primitive["extensions"][variants]["mappings"]) holders.push_back(&mapping);
  return holders;
}

/// A whole number of at least 0, as which check_gltf_types() knows `json[key]`; `fallback` where there is
/// none.
std::uint64_t whole_or(const GltfJson& json, const char* key, std::uint64_t fallback);

}  // namespace lambake
