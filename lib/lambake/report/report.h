#pragma once

#include <span>
#include <string>
#include <vector>

#include "lambake/report/comparison.h"

namespace lambake {

/// report.json: the numbers of a comparison (docs/report.schema.json). Keys in a fixed order.
std::string report_json(const Comparison& comparison);

/// index.html: one self-contained page that opens from disk without a network.
/// @throws IoError if its pictures cannot be encoded.
std::string report_page(const Comparison& comparison);

/// Signed heat map of test − reference, on screen (sRGB, clamped to [0,1]), of the channel with the largest
/// |d|: blue where the test is darker, white where equal, red where brighter, dark grey where `visibility` is
/// not covered, magenta where a side is not finite. Differences beyond the scale have its end colour.
///
/// W×(H + strip): the upper H rows are the map, the strip holds a colour bar with its numbers in steps of
/// 1/255. `scale` is the value at the ends of the bar, in [0,1]; 0 takes heat_map_scale().
/// @throws InvalidOption if sizes differ.
Picture heat_map(const Picture& test, const Picture& reference, const Visibility& visibility, double scale);

/// The scale that heat_map() picks: the first of 1, 2, 4, …, 128, 255 steps of 1/255 that is at least the
/// 99th percentile of the covered pixels' differences.
double heat_map_scale(const Picture& test, const Picture& reference, const Visibility& visibility);

/// Signed differences on screen in the colours of heat_map(), for the triangles of a mesh.
/// @param scale  the value at the ends of the colours, in (0,1].
std::vector<Srgb8> heat_colors(std::span<const float> differences, double scale);

}  // namespace lambake
