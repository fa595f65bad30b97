#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "lambake/io/canonical_file.h"

namespace lambake {

/// Appends the row of a face to those of a canonical PLY: the number of its corners, then these.
inline void append_face_row(std::string& rows, std::span<const std::uint32_t> corners) {
  const auto n = static_cast<std::uint32_t>(corners.size());
  rows.append(reinterpret_cast<const char*>(&n), sizeof n);
  rows.append(reinterpret_cast<const char*>(corners.data()), corners.size_bytes());
}

/// Puts `file.bytes` together: a binary PLY.
/// @param vertex_rows  the V rows of the file's vertices, in floats: x y z, nx ny nz if the file
///                     `has_normals`, u v if it `has_texcoords`. Copies get the rows of their vertices.
void write_canonical_ply(std::string&& vertex_rows, std::string&& face_rows, std::size_t n_faces,
                         CanonicalFile& file);

}  // namespace lambake
