#include "lambake/io/gltf/source.h"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <span>
#include <string_view>

#include "lambake/core/error.h"
#include "lambake/io/file_extension.h"
#include "lambake/io/gltf/parse.h"
#include "lambake/io/gltf/types.h"
#include "lambake/io/input_file.h"
#include "lambake/io/json_text.h"

namespace lambake {
namespace {

constexpr std::array<std::string_view, 20> known_extensions{
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    // Without a part in Lambert light: gloss, names and animation.
    "KHR_animation_pointer",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_xmp_json_ld",
};

std::vector<unsigned char> all_bytes(InputFile file) {
  std::vector<unsigned char> bytes(file.size());
  file.read(reinterpret_cast<char*>(bytes.data()), bytes.size());
  return bytes;
}

/// Bytes of the file that a relative URI names, beside `path`.
std::vector<unsigned char> read_beside(const std::string& path, const std::string& uri) {
  try {
    return all_bytes(InputFile(file_beside(path, uri).string(), /* may_be_pipe */ false));
  } catch (const IoError& error) {
    throw IoError(path, error.what());
  }
}

std::uint32_t u32_at(const std::vector<unsigned char>& bytes, std::size_t at) {
  return bytes[at] | bytes[at + 1] << 8 | bytes[at + 2] << 16 | std::uint32_t{bytes[at + 3]} << 24;
}

/// The two chunks of a GLB, as ranges of its bytes.
struct GlbChunks {
  std::span<const unsigned char> json, bin;
  std::size_t n_unknown = 0;  ///< More of them, which are not read.
};

GlbChunks split_glb(const std::vector<unsigned char>& bytes, const std::string& path) {
  const auto fail = [&](std::size_t at, const std::string& text) {
    throw IoError(path, fmt::format("byte {}: {}", at, text));
  };
  if (bytes.size() < 20)
    fail(0, fmt::format("expected a GLB header and chunk of 20 bytes, found {} bytes", bytes.size()));
  if (u32_at(bytes, 4) != 2) fail(4, fmt::format("expected GLB version 2, found {}", u32_at(bytes, 4)));
  if (u32_at(bytes, 8) != bytes.size())
    fail(8, fmt::format("expected the file's length {}, found {}", bytes.size(), u32_at(bytes, 8)));
  GlbChunks chunks;
  for (std::size_t at = 12, i = 0; at < bytes.size(); ++i) {
    if (bytes.size() - at < 8) fail(at, "expected a chunk header of 8 bytes, found the end");
    const std::size_t n_bytes = u32_at(bytes, at);
    const std::uint32_t type = u32_at(bytes, at + 4);
    if (n_bytes > bytes.size() - at - 8)
      fail(at, fmt::format("expected a chunk of at most {} bytes, found the length {}", bytes.size() - at - 8,
                           n_bytes));
    const std::span<const unsigned char> chunk(bytes.data() + at + 8, n_bytes);
    if (i == 0 && type != 0x4E4F534A) fail(at + 4, "expected the JSON chunk first");
    if (i == 0) chunks.json = chunk;
    if (i == 1 && type == 0x004E4942)
      chunks.bin = chunk;
    else
      chunks.n_unknown += i > 0;
    at += 8 + n_bytes;
  }
  return chunks;
}

/// Of another version more than a type may be different: it is checked first.
void check_version(const GltfSource& source) {
  const GltfJson& version = member(member(source.json, "asset"), "version");
  if (version.is_string() && !version.get_ref<const std::string&>().starts_with("2."))
    throw IoError(source.path, "asset.version: expected \"2.0\", found " + shown(version));
}

/// Each of the instances would take light of its own.
void check_instances(const GltfSource& source) {
  const GltfJson& nodes = member(source.json, "nodes");
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (!member(member(nodes[n], "extensions"), gltf::instancing).is_null())
      throw IoError(source.path, fmt::format("nodes[{}]: expected a mesh placed once, found instances by {}: "
                                             "write them out as nodes first",
                                             n, gltf::instancing));
}

void check_asset(const GltfSource& source) {
  const GltfJson& version = member(member(source.json, "asset"), "version");
  if (!version.is_string())
    throw IoError(source.path, "asset.version: expected \"2.0\", found " + shown(version));
  const GltfJson& least = member(member(source.json, "asset"), "minVersion");
  if (least.is_string() && least != "2.0")
    throw IoError(source.path, "asset.minVersion: expected \"2.0\", found " + shown(least));
  check_instances(source);
  for (const GltfJson& name : member(source.json, "extensionsRequired"))
    if (!is_known_extension(name.get<std::string>()))
      throw IoError(source.path,
                    fmt::format("the file requires the extension {}, which is not known", shown(name)));
}

std::vector<unsigned char> read_buffer(const GltfSource& source, std::size_t index,
                                       std::span<const unsigned char> bin) {
  const GltfJson& buffer = source.json["buffers"][index];
  const std::string where = fmt::format("buffers[{}]", index);
  const std::uint64_t n_bytes = whole_or(buffer, "byteLength", 0);
  const GltfJson& uri = member(buffer, "uri");
  if (uri.is_null()) {
    const GltfJson& meshopt = member(member(buffer, "extensions"), "EXT_meshopt_compression");
    if (meshopt.is_object() && (member(meshopt, "fallback") == true || index > 0)) return {};
    if (index != 0 || !source.is_glb) throw IoError(source.path, where + ".uri: expected one, found none");
    if (n_bytes > bin.size())
      throw IoError(source.path, fmt::format("{}: expected {} bytes, found a binary chunk of {}", where,
                                             n_bytes, bin.size()));
    return {bin.begin(), bin.begin() + static_cast<std::ptrdiff_t>(n_bytes)};
  }
  std::vector<unsigned char> bytes;
  const std::string& text = uri.get_ref<const std::string&>();
  if (is_data_uri(text)) {
    std::optional<std::vector<unsigned char>> data = bytes_of_data_uri(text);
    if (!data)
      throw IoError(source.path, where + ".uri: expected data:application/octet-stream;base64 or the like");
    bytes = std::move(*data);
  } else {
    bytes = read_beside(source.path, text);
  }
  if (bytes.size() < n_bytes)
    throw IoError(source.path, fmt::format("{}: expected {} bytes, found {}", where, n_bytes, bytes.size()));
  bytes.resize(n_bytes);
  return bytes;
}

/// Behind white space and a byte order mark.
bool begins_json(const std::vector<unsigned char>& bytes) {
  constexpr std::string_view before = " \t\r\n\xEF\xBB\xBF";
  const auto begin = std::find_if(bytes.begin(), bytes.end(), [&](unsigned char byte) {
    return before.find(static_cast<char>(byte)) == std::string_view::npos;
  });
  return begin != bytes.end() && *begin == '{';
}

/// Its first four bytes, for people.
std::string beginning_of(const std::vector<unsigned char>& bytes) {
  const std::span<const unsigned char> first(bytes.data(), std::min<std::size_t>(4, bytes.size()));
  if (first.empty()) return "nothing";
  if (std::all_of(first.begin(), first.end(), [](unsigned char byte) { return byte >= ' ' && byte < 127; }))
    return fmt::format("\"{}\"", std::string(first.begin(), first.end()));
  return fmt::format("the bytes {:02x}", fmt::join(first, " "));
}

}  // namespace

bool is_known_extension(const std::string& name) {
  return std::find(known_extensions.begin(), known_extensions.end(), name) != known_extensions.end();
}

const GltfJson& member(const GltfJson& json, const char* key) {
  static const GltfJson none;
  if (!json.is_object()) return none;
  const auto it = json.find(key);
  return it == json.end() ? none : *it;
}

std::uint64_t whole_or(const GltfJson& json, const char* key, std::uint64_t fallback) {
  const GltfJson& value = member(json, key);
  return value.is_null() ? fallback : value.get<std::uint64_t>();
}

std::string decode_percent(const std::string& uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const auto digit = [](char c) {
      return c >= '0' && c <= '9'   ? c - '0'
             : c >= 'a' && c <= 'f' ? c - 'a' + 10
             : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                    : -1;
    };
    if (uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0) {
      text += static_cast<char>(16 * digit(uri[i + 1]) + digit(uri[i + 2]));
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

std::filesystem::path file_beside(const std::string& path, const std::string& uri) {
  return std::filesystem::path(path).parent_path() / decode_percent(uri);
}

bool is_data_uri(const std::string& uri) {
  return in_lower_case(uri.substr(0, 5)) == "data:";
}

std::optional<std::vector<unsigned char>> bytes_of_data_uri(const std::string& uri) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string::npos) return std::nullopt;
  const std::string text = decode_percent(uri.substr(comma + 1));
  if (!in_lower_case(uri.substr(0, comma)).ends_with(";base64"))
    return std::vector<unsigned char>(text.begin(), text.end());
  std::vector<unsigned char> bytes;
  std::string mime_type;
  if (!text.empty() &&
      !tinygltf::DecodeDataURI(&bytes, mime_type, "data:application/octet-stream;base64," + text, 0,
                               /* check size */ false))
    return std::nullopt;
  return bytes;
}

GltfSource read_gltf_source(const std::string& path) {
  const std::vector<unsigned char> bytes = all_bytes(InputFile(path));
  GltfSource source;
  source.path = path;
  source.is_glb = bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
  if (!source.is_glb && file_extension(path) == "glb" && !begins_json(bytes))
    throw IoError(path, fmt::format("byte 0: expected \"glTF\" or JSON, found {}", beginning_of(bytes)));
  const GlbChunks chunks = source.is_glb ? split_glb(bytes, path) : GlbChunks{bytes, {}};
  source.n_unknown_chunks = chunks.n_unknown;
  source.json = parse_gltf_json(chunks.json, path);
  if (!source.json.is_object()) throw IoError(path, "expected a JSON object");
  check_version(source);
  check_gltf_types(path, source.json);
  check_asset(source);
  for (std::size_t i = 0; i < member(source.json, "buffers").size(); ++i)
    source.buffers.push_back(read_buffer(source, i, chunks.bin));
  return source;
}

}  // namespace lambake
