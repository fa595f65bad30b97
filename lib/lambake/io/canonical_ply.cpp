#include "lambake/io/canonical_ply.h"

#include <fmt/format.h>

namespace lambake {

void write_canonical_ply(std::string&& vertex_rows, std::string&& face_rows, std::size_t n_faces,
                         CanonicalFile& file) {
  std::string& out = file.bytes;
  out = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\n{}{}element face {}\nproperty list int int vertex_indices\nend_header\n",
      file.n_vertices + file.copied_vertices.size(),
      file.has_normals ? "property float nx\nproperty float ny\nproperty float nz\n" : "",
      file.has_texcoords ? "property float u\nproperty float v\n" : "", n_faces);
  const std::size_t row_size = 4 * (3 + (file.has_normals ? 3 : 0) + (file.has_texcoords ? 2 : 0));
  out.reserve(out.size() + vertex_rows.size() + row_size * file.copied_vertices.size() + face_rows.size());
  out += vertex_rows;
  for (const std::uint32_t v : file.copied_vertices) out.append(vertex_rows, v * row_size, row_size);
  std::string().swap(vertex_rows);  // An assignment would keep the memory.
  out += face_rows;
  std::string().swap(face_rows);
}

}  // namespace lambake
