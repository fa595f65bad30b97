#include "lambake/io/gltf/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <filesystem>
#include <limits>
#include <set>

#include "lambake/core/error.h"
#include "lambake/io/file_extension.h"
#include "lambake/io/gltf/source.h"
#include "lambake/io/output_file.h"

namespace lambake {
namespace {

constexpr std::uint32_t glb_magic = 0x46546C67, json_chunk = 0x4E4F534A, bin_chunk = 0x004E4942;

std::uint64_t padded(std::uint64_t n_bytes) {
  return (n_bytes + 3) / 4 * 4;
}

void write_u32(OutputFile& file, std::uint64_t value) {
  unsigned char bytes[4];
  for (int i = 0; i < 4; ++i) bytes[i] = static_cast<unsigned char>(value >> (8 * i));
  file.write(bytes, 4);
}

/// A URI of a file name: everything but the unreserved characters of RFC 3986 as %XX.
std::string uri_of(const std::string& name) {
  std::string uri;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_unreserved = (byte >= 'a' && byte <= 'z') || (byte >= 'A' && byte <= 'Z') ||
                               (byte >= '0' && byte <= '9') || c == '-' || c == '.' || c == '_' || c == '~';
    uri += is_unreserved ? std::string(1, c) : fmt::format("%{:02X}", byte);
  }
  return uri;
}

/// The bytes of `buffers[0]`.
std::uint64_t buffer_size(const GltfDocument& document) {
  if (!document.bin.empty() || document.lent.empty()) return bin_offset(document) + document.bin.size();
  return document.lent.back().begin + document.lent.back().bytes.size();  // The last part is not padded.
}

void write_buffer(OutputFile& file, const GltfDocument& document) {
  constexpr char zeros[] = "\0\0\0";
  std::uint64_t size = 0;
  for (const auto& [bytes, begin] : document.lent) {
    file.write(zeros, begin - size);
    file.write(bytes.data(), bytes.size());
    size = begin + bytes.size();
  }
  if (document.bin.empty()) return;
  file.write(zeros, padded(size) - size);
  file.write(document.bin.data(), document.bin.size());
}

void write_glb(const std::string& path, const GltfDocument& document) {
  const std::string text = document.json.dump();
  const std::uint64_t bin_size = buffer_size(document);
  check_glb_size(path, text.size(), bin_size);
  const std::uint64_t bin_part = bin_size == 0 ? 0 : 8 + padded(bin_size);
  const char spaces[] = "   ", zeros[] = "\0\0\0";
  OutputFile file(path);
  write_u32(file, glb_magic);
  write_u32(file, 2);
  write_u32(file, 12 + 8 + padded(text.size()) + bin_part);
  write_u32(file, padded(text.size()));
  write_u32(file, json_chunk);
  file.write(text);
  file.write(spaces, padded(text.size()) - text.size());
  if (bin_size != 0) {
    write_u32(file, padded(bin_size));
    write_u32(file, bin_chunk);
    write_buffer(file, document);
    file.write(zeros, padded(bin_size) - bin_size);
  }
  file.commit();
}

void write_gltf_and_bin(const std::string& path, GltfDocument& document) {
  const std::filesystem::path bin_path = std::filesystem::path(path).replace_extension(".bin");
  const bool has_buffer = buffer_size(document) != 0;
  if (has_buffer) document.json["buffers"][0]["uri"] = uri_of(bin_path.filename().string());
  OutputFile file(path);
  file.write(document.json.dump(2) + "\n");
  if (has_buffer) {
    OutputFile bin(bin_path.string());
    write_buffer(bin, document);
    bin.commit();
  }
  file.commit();
}

}  // namespace

std::size_t bin_offset(const GltfDocument& document) {
  return document.lent.empty() ? 0 : padded(document.lent.back().begin + document.lent.back().bytes.size());
}

void lend(GltfDocument& document, std::span<const unsigned char> bytes) {
  document.lent.push_back({bytes, bin_offset(document)});
}

IndexElements::IndexElements(std::span<const glm::uvec3> triangles, std::size_t n_vertices)
    : triangles_(triangles) {
  // 65535 is kept free: it restarts primitives on some hardware.
  if (n_vertices > std::numeric_limits<std::uint16_t>::max()) return;
  short_.reserve(3 * triangles.size());
  for (const glm::uvec3& t : triangles)
    for (int c = 0; c < 3; ++c) short_.push_back(static_cast<std::uint16_t>(t[c]));
}

GltfElements IndexElements::elements() const {
  const bool is_short = short_.size() == 3 * triangles_.size();
  return {.bytes = is_short ? bytes_of(std::span(short_)) : bytes_of(triangles_),
          .count = 3 * triangles_.size(),
          .component_type = is_short ? gltf::unsigned_short : gltf::unsigned_int,
          .type = "SCALAR",
          .target = gltf::element_array_buffer};
}

std::size_t append_to(GltfJson& json, const char* key, GltfJson value) {
  GltfJson& array = json[key];
  array.push_back(std::move(value));
  return array.size() - 1;
}

void use_extension(GltfJson& json, const char* name) {
  GltfJson& used = json["extensionsUsed"];
  if (std::find(used.begin(), used.end(), name) == used.end()) used.push_back(name);
}

std::size_t append_view(GltfDocument& document, std::span<const unsigned char> bytes, int target,
                        std::size_t stride, bool is_lent) {
  assert(!is_lent || document.bin.empty());
  document.bin.resize(padded(document.bin.size()));
  GltfJson view{{"buffer", 0},
                {"byteOffset", bin_offset(document) + document.bin.size()},
                {"byteLength", bytes.size()}};
  if (stride != 0) view["byteStride"] = stride;
  if (target != 0) view["target"] = target;
  if (is_lent) {
    lend(document, bytes);
  } else {
    document.bin.insert(document.bin.end(), bytes.begin(), bytes.end());
  }
  return append_to(document.json, "bufferViews", std::move(view));
}

std::size_t append_accessor(GltfDocument& document, const GltfElements& elements) {
  const std::size_t stride = elements.is_strided ? elements.bytes.size() / elements.count : 0;
  const std::size_t view = append_view(document, elements.bytes, elements.target, stride, elements.is_lent);
  GltfJson accessor{{"bufferView", view},
                    {"componentType", elements.component_type},
                    {"count", elements.count},
                    {"type", elements.type}};
  if (elements.is_normalized) accessor["normalized"] = true;
  return append_to(document.json, "accessors", std::move(accessor));
}

void check_glb_size(const std::string& path, std::uint64_t n_json_bytes, std::uint64_t n_bin_bytes) {
  const std::uint64_t total = 12 + 8 + padded(n_json_bytes) + 8 + padded(n_bin_bytes);
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw IoError(path, fmt::format("a GLB holds at most 4294967295 bytes and this one would have {}: write "
                                    "a .gltf instead, whose .bin has no such limit",
                                    total));
}

std::size_t count_vertices(const GltfJson& document) {
  std::set<std::size_t> accessors;
  for (const GltfJson& mesh : member(document, "meshes"))
    for (const GltfJson& primitive : member(mesh, "primitives"))
      if (const GltfJson& position = member(member(primitive, "attributes"), "POSITION");
          position.is_number())
        accessors.insert(position.get<std::size_t>());
  std::size_t n = 0;
  for (const std::size_t accessor : accessors)
    n += document["accessors"][accessor]["count"].get<std::size_t>();
  return n;
}

void write_document(const std::string& path, GltfDocument& document) {
  if (const std::uint64_t size = buffer_size(document); size != 0) {
    GltfJson& buffers = document.json["buffers"];
    if (buffers.empty()) buffers.push_back(GltfJson::object());
    buffers[0]["byteLength"] = size;
  }
  const std::string extension = file_extension(path);
  if (extension == "glb") {
    write_glb(path, document);
  } else if (extension == "gltf") {
    write_gltf_and_bin(path, document);
  } else {
    throw InvalidOption(path + ": expected a name ending in .glb or .gltf");
  }
}

}  // namespace lambake
