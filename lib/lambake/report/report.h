#pragma once

#include <string>

#include "lambake/report/comparison.h"

namespace lambake {

/// report.json: the numbers of a comparison (docs/report.schema.json). Keys in a fixed order.
std::string report_json(const Comparison& comparison);

/// index.html: one self-contained page that opens from disk without a network.
std::string report_page(const Comparison& comparison);

/// Signed heat map of test − reference, largest channel, on screen (sRGB): blue where the test is darker, red
/// where brighter, with a colour bar that says the scale. `scale` is the value at the ends of the bar; 0
/// picks one.
Picture heat_map(const Picture& test, const Picture& reference, const Visibility& visibility, double scale);

}  // namespace lambake
