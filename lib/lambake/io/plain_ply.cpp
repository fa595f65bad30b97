#include "lambake/io/plain_ply.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string_view>
#include <utility>

namespace lambake {
namespace {

static_assert(std::endian::native == std::endian::little);

bool are_floats(const std::vector<PlyProperty>& properties, std::size_t first,
                std::initializer_list<std::string_view> names) {
  if (properties.size() < first + names.size()) return false;
  for (const std::string_view name : names) {
    const PlyProperty& p = properties[first++];
    if (p.is_list || p.type != PlyType::f32 || p.name != name) return false;
  }
  return true;
}

bool is_index_list(const PlyProperty& p) {
  const bool is_named = p.name == "vertex_indices" || p.name == "vertex_index";
  return p.is_list && is_named && (p.type == PlyType::i32 || p.type == PlyType::u32) &&
         p.count_type == PlyType::u8;
}

/// The end of the faces that begin at `at` if they have three or more corners, each below `n_vertices`
/// (< 2^31); none otherwise.
const char* end_of_sound_faces(const char* at, const char* end, std::size_t n_faces,
                               std::uint32_t n_vertices) {
  for (std::size_t f = 0; f < n_faces; ++f) {
    if (at == end) return nullptr;
    const auto n_corners = static_cast<unsigned char>(*at++);
    if (n_corners < 3 || static_cast<std::size_t>(end - at) < 4U * n_corners) return nullptr;
    std::uint32_t largest = 0;  // A negative index is one of 2^31 and more.
    for (unsigned c = 0; c < n_corners; ++c, at += 4) {
      std::uint32_t index;
      std::memcpy(&index, at, 4);
      largest = index > largest ? index : largest;
    }
    if (largest >= n_vertices) return nullptr;
  }
  return at;
}

}  // namespace

bool take_plain_ply(const PlyHeader& header, std::string& text, CanonicalFile& file) {
  if (header.encoding != PlyEncoding::little_endian || header.elements.size() != 2) return false;
  const PlyElement &vertex = header.elements[0], &face = header.elements[1];
  if (vertex.name != "vertex" || face.name != "face" || vertex.count == 0 || face.count == 0 ||
      vertex.count > std::numeric_limits<std::int32_t>::max() || !header.texture_files.empty())
    return false;
  const std::vector<PlyProperty>& properties = vertex.properties;
  if (!are_floats(properties, 0, {"x", "y", "z"})) return false;
  const bool has_normals = are_floats(properties, 3, {"nx", "ny", "nz"});
  const std::size_t n_before = has_normals ? 6 : 3;
  const bool has_texcoords = are_floats(properties, n_before, {"u", "v"});
  const std::size_t n_floats = n_before + (has_texcoords ? 2 : 0);
  if (properties.size() != n_floats || face.properties.size() != 1 || !is_index_list(face.properties[0]))
    return false;

  // The reader gets a header of ours, in the place of the file's: comments and spellings are no matter then.
  const std::string canonical = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\n{}{}element face {}\nproperty list uchar {} {}\nend_header\n",
      vertex.count, has_normals ? "property float nx\nproperty float ny\nproperty float nz\n" : "",
      has_texcoords ? "property float u\nproperty float v\n" : "", face.count,
      face.properties[0].type == PlyType::i32 ? "int" : "uint", face.properties[0].name);
  if (canonical.size() > header.size) return false;
  const std::size_t faces_begin = header.size + 4 * n_floats * vertex.count;
  if (text.size() < faces_begin) return false;
  const char* const end = text.data() + text.size();
  const char* const faces_end = end_of_sound_faces(text.data() + faces_begin, end, face.count,
                                                   static_cast<std::uint32_t>(vertex.count));
  if (faces_end == nullptr) return false;

  tell_bytes_left_over(static_cast<std::size_t>(end - faces_end), file.findings);
  file.bytes = std::move(text);
  file.begin = header.size - canonical.size();
  file.bytes.replace(file.begin, canonical.size(), canonical);
  file.n_vertices = vertex.count;
  file.n_faces = face.count;
  file.has_normals = has_normals;
  file.has_texcoords = has_texcoords;
  return true;
}

}  // namespace lambake
