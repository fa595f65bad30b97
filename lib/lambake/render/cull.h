#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "lambake/render/screen.h"

namespace lambake {

/// Appends, in their order, the triangles of [begin, end) that may be seen: not those that lie beside the
/// picture, have a vertex that is not finite, have no area on the subpixel grid, or reach no pixel's centre.
/// The last is exact where a triangle's box holds at most 2×2 centres, as on fine meshes most do; larger
/// triangles are kept. Ones to be clipped are kept.
void find_candidates(std::span<const ScreenVertex> vertices, std::span<const glm::uvec3> triangles,
                     std::size_t begin, std::size_t end, std::vector<std::uint32_t>& candidates);

}  // namespace lambake
