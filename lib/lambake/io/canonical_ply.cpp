#include "lambake/io/canonical_ply.h"

namespace lambake {

PlyElement canonical_vertices(std::size_t count, bool has_normals, bool has_texcoords) {
  PlyElement vertex{"vertex", count};
  add_properties(vertex, PlyType::f32, {"x", "y", "z"});
  if (has_normals) add_properties(vertex, PlyType::f32, {"nx", "ny", "nz"});
  if (has_texcoords) add_properties(vertex, PlyType::f32, {"u", "v"});
  return vertex;
}

void write_canonical_ply(std::string&& vertex_rows, std::string&& face_rows, std::size_t n_faces,
                         CanonicalFile& file) {
  const PlyElement vertex =
      canonical_vertices(file.n_vertices + file.copied_vertices.size(), file.has_normals, file.has_texcoords);
  const PlyElement face{"face", n_faces, {{"vertex_indices", PlyType::i32, true, PlyType::i32}}};
  std::string& out = file.bytes;
  out = ply_header_text({}, {vertex, face});
  const std::size_t size = row_size(vertex);
  out.reserve(out.size() + vertex_rows.size() + size * file.copied_vertices.size() + face_rows.size());
  out += vertex_rows;
  for (const std::uint32_t v : file.copied_vertices) out.append(vertex_rows, v * size, size);
  std::string().swap(vertex_rows);  // An assignment would keep the memory.
  out += face_rows;
  std::string().swap(face_rows);
}

}  // namespace lambake
