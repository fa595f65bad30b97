#pragma once

#include "lambake/core/finding.h"
#include "lambake/io/gltf/asset.h"

/// One file out of a document, its buffers and its images; internal to io.
namespace lambake {

/// Puts the bytes of all buffers of the asset, and of images beside it or in data URIs, into the document's
/// one buffer: views keep their bytes and their order. Buffers without bytes of their own (the fallbacks of
/// EXT_meshopt_compression) stay, after the first. Images that are missing keep their name.
/// @param document  its JSON is the asset's; it borrows the asset's bytes.
void merge_buffers(const GltfAsset& asset, GltfDocument& document, Findings& findings);

}  // namespace lambake
