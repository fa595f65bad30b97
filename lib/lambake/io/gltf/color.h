#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lambake/core/color.h"
#include "lambake/io/color_storage.h"
#include "lambake/io/gltf/document.h"

/// Vertex colours as the elements of an accessor; internal to io.
namespace lambake {

struct EncodedColors {
  std::vector<unsigned char> bytes;
  std::size_t count = 0;
  int component_type = gltf::float_;
  const char* type = "VEC4";
  bool is_normalized = false;
  StorageLosses losses;

  GltfElements elements() const {
    return {.bytes = bytes,
            .count = count,
            .component_type = component_type,
            .type = type,
            .is_normalized = is_normalized};
  }
};

/// The colours that a writer has from baked ones.
struct ColorFolding {
  LinearRgb factor{1, 1, 1}, shift{0, 0, 0};
  LinearRgb operator()(const LinearRgb& baked) const { return factor * baked + shift; }
};

struct ColorEncoding {
  ColorStorage storage = ColorStorage::u16;
  /// COLOR_0 lies in [0,1] by the specification, as floats too; another attribute of floats may hold more.
  bool is_clamped = true;
};

/// n linear colours, and n opacities or none. Integers are always four channels, which keeps elements
/// aligned to 4 bytes; floats have three unless there are opacities. Channels that are no number become 0.
EncodedColors encode_colors(std::span<const LinearRgb> colors, std::span<const float> opacities,
                            const ColorEncoding& encoding);

/// What encode_colors() holds of one colour.
LinearRgb encoded_color(const LinearRgb& color, const ColorEncoding& encoding);

}  // namespace lambake
