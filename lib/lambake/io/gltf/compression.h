#pragma once

#include "lambake/io/gltf/source.h"

/// Compressed buffer views and primitives, unpacked before the file is looked at; internal to io.
namespace lambake {

/// Rewrites `plain` (a copy of `source.json`) and `buffers` so that nothing in them is compressed any more:
/// each view of EXT_meshopt_compression points to a buffer of its own with the decoded bytes, and so does
/// each accessor that KHR_draco_mesh_compression fills. Counts are checked against what the compressed bytes
/// can hold before anything is allocated.
/// @throws IoError with the place if a stream does not decode.
void decompress(const GltfSource& source, GltfJson& plain, std::vector<std::vector<unsigned char>>& buffers);

}  // namespace lambake
