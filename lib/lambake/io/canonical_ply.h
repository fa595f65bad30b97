#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "lambake/io/canonical_file.h"
#include "lambake/io/ply_header.h"

namespace lambake {

/// The vertices of a canonical PLY: floats x y z, then nx ny nz if there are normals, u v if there are
/// texture coordinates.
PlyElement canonical_vertices(std::size_t count, bool has_normals, bool has_texcoords);

/// Appends `n` values to rows as they lie in memory.
template <typename T>
void append_values(std::string& rows, const T* values, std::size_t n = 1) {
  rows.append(reinterpret_cast<const char*>(values), n * sizeof(T));
}

/// Appends the row of a face to those of a canonical PLY: the number of its corners, then these.
inline void append_face_row(std::string& rows, std::span<const std::uint32_t> corners) {
  const auto n = static_cast<std::uint32_t>(corners.size());
  append_values(rows, &n);
  append_values(rows, corners.data(), corners.size());
}

/// Puts `file.bytes` together: a binary PLY.
/// @param vertex_rows  of the V vertices of the file. Copies get the rows of their vertices.
void write_canonical_ply(std::string&& vertex_rows, std::string&& face_rows, std::size_t n_faces,
                         CanonicalFile& file);

}  // namespace lambake
