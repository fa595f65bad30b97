#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lambake/core/color.h"

namespace lambake {

/// A rendered picture: linear RGB, W×H, row by row from the top, unclamped.
struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<LinearRgb> pixels;  ///< W·H.

  std::size_t n_pixels() const { return pixels.size(); }
};

}  // namespace lambake
