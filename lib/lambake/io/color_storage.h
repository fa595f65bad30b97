#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>

#include "lambake/core/color.h"
#include "lambake/core/finding.h"

namespace lambake {

/// How a vertex colour is stored in COLOR_0 (linear, by the specification) and in PLY (u8 is sRGB-encoded
/// there).
enum class ColorStorage { u8, u16, f32 };

/// What became of the colours on the way into a file.
struct WrittenColors {
  std::size_t n_vertices = 0;        ///< That the file has, one that several primitives share once.
  std::size_t clipped_vertices = 0;  ///< Above what the storage can hold (1); never silent.
  Findings findings;
};

/// What a storage could not hold.
struct StorageLosses {
  std::size_t n_above = 0;  ///< Vertices with a channel above 1, stored as 1.
  std::size_t n_below = 0;  ///< Vertices with a channel below 0, stored as 0.
  float brightest = 0;      ///< Channel of a colour, if there are any above 1.

  void add(const StorageLosses& other) {
    n_above += other.n_above;
    n_below += other.n_below;
    brightest = std::max(brightest, other.brightest);
  }
};

/// The largest finite channel; at least 0.
float brightest_of(std::span<const LinearRgb> colors);

/// How much lower an exposure leaves nothing above 1: "an exposure lower by 3 stops".
/// @param brightest  above 1.
std::string exposure_to_white(float brightest);

void tell_storage(Findings& findings, const StorageLosses& losses);

}  // namespace lambake
