#pragma once

#include <cstdint>

namespace lambake {

/// A vertex that was made on the line between two earlier ones: value = (1 − t)·value[a] + t·value[b],
/// for every attribute (normals are renormalised). 0 < t < 1.
struct EdgeCut {
  std::uint32_t a = 0, b = 0;
  float t = 0.5f;
};

}  // namespace lambake
