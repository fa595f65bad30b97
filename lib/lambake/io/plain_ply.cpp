#include "lambake/io/plain_ply.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "lambake/io/canonical_ply.h"

namespace lambake {
namespace {

static_assert(std::endian::native == std::endian::little);

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
  const std::size_t n_floats = vertex.properties.size();
  const bool has_normals = n_floats >= 6, has_texcoords = n_floats == 5 || n_floats == 8;
  if (vertex.properties != canonical_vertices(0, has_normals, has_texcoords).properties) return false;
  if (face.properties.size() != 1 || !is_index_list(face.properties[0])) return false;
  const PlyProperty& indices = face.properties[0];
  if (indices.count_type != PlyType::u8 || (indices.type != PlyType::i32 && indices.type != PlyType::u32))
    return false;

  // The reader gets a header of ours, in the place of the file's: comments and spellings are no matter then.
  const std::string canonical = ply_header_text({}, header.elements);
  if (canonical.size() > header.size) return false;
  const std::size_t faces_begin = header.size + row_size(vertex) * vertex.count;
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
