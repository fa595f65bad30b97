#pragma once

#include <array>
#include <cstddef>
#include <string>

namespace lambake {

/// Inline SVG of a histogram of `bins` counts, bin i for differences of i/255: bars of the logarithm, so that
/// a single pixel still shows; empty bins beyond the last used one are left out. Colours come from the style
/// sheet of the page.
std::string histogram_svg(const std::array<std::size_t, 256>& bins);

}  // namespace lambake
