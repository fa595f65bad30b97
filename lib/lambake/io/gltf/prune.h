#pragma once

#include "lambake/io/gltf/document.h"

namespace lambake {

/// Takes out the accessors, buffer views and bytes that `source` uses and `document.json`, made from it, does
/// not any more. What nothing used in the source either stays. So does everything where an extension might
/// refer to it in ways that are not known.
/// @param document  its JSON has the source's accessors and views first, in their order; all its views are
/// of its one buffer or of fallbacks without bytes.
void drop_replaced(const GltfJson& source, GltfDocument& document);

}  // namespace lambake
