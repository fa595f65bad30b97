#pragma once

#include <cstddef>

#include "lambake/core/finding.h"

namespace lambake {

/// How a vertex colour is stored in COLOR_0 (linear, by the specification) and in PLY (u8 is sRGB-encoded
/// there).
enum class ColorStorage { u8, u16, f32 };

/// What became of the colours on the way into a file.
struct WrittenColors {
  std::size_t clipped_vertices = 0;  ///< Above what the storage can hold (1); never silent.
  Findings findings;
};

/// Tells of vertices whose colours the storage could not hold: above 1 and below 0.
void tell_storage(Findings& findings, std::size_t clipped, std::size_t negative);

}  // namespace lambake
