#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "lambake/render/visibility.h"
#include "lambake/scene/picture.h"

/// Test − reference, pixel by pixel, on screen (sRGB, clamped to [0,1]). Internal to the folder.
namespace lambake {

/// Of pixels that no triangle covers, in heat maps and on the page: no colour of the maps, and not the black
/// of a surface without light.
inline constexpr Srgb8 uncovered{58, 60, 66};

/// W×H: d of the channel with the largest |d|, signed; NaN where a side is not finite, 0 where nothing is
/// covered. @throws InvalidOption if sizes differ.
std::vector<float> screen_difference(const Picture& test, const Picture& reference,
                                     const Visibility& visibility);

/// heat_map_scale() of such differences.
double scale_of(const std::vector<float>& differences, const Visibility& visibility);

/// The colour of the maps for t in [−1, 1]: −1 darker, 0 equal, 1 brighter; clamped beyond.
LinearRgb diverging_color(double t);

/// The same as a CSS gradient from left (−1) to right (1).
std::string diverging_gradient_css();

/// W×H: heat_map() without its bar.
Picture color_difference(const std::vector<float>& differences, const Visibility& visibility, double scale);

struct WorstPixel {
  std::uint32_t x = 0, y = 0;
  float difference = 0;  ///< Signed.
};

/// The pixels with the largest |d|, largest first, no two of them nearer than `distance` in both x and y; at
/// most `n`, and none with less than one step of 1/255.
std::vector<WorstPixel> worst_pixels(const std::vector<float>& differences, std::uint32_t width,
                                     std::size_t n, std::uint32_t distance);

}  // namespace lambake
