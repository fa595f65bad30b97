#pragma once

#include <string>

#include "lambake/io/canonical_file.h"
#include "lambake/io/ply_header.h"

namespace lambake {

/// Takes a binary PLY that is canonical already as it is: little-endian, with vertices of float x, y, z (then
/// nx, ny, nz, then u, v), faces of one list of three or more sound indices, and nothing else. Most files are
/// so, and are then neither copied nor looked at value by value.
/// @param text  the whole file; moved into `file.bytes` if it is plain.
/// @returns false, with nothing changed, if it is not plain: the scan then says what is wrong, or rewrites
/// it.
bool take_plain_ply(const PlyHeader& header, std::string& text, CanonicalFile& file);

}  // namespace lambake
