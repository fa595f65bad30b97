#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "lambake/core/color.h"
#include "lambake/core/finding.h"

namespace lambake {

/// What the channels of a file's colours were before they were divided by the largest that their type holds.
enum class ChannelNumbers { floats, whole };

/// Colours as a mesh file has them, sRGB-encoded in [0,1], made linear in place. Not finite becomes white,
/// outside of [0,1] is clamped, and where a channel of floats is above 2 the file is taken to count to 255;
/// each is counted.
/// @returns whether the file counts to 255.
bool decode_file_colors(std::vector<LinearRgb>& colors, Findings& findings,
                        ChannelNumbers numbers = ChannelNumbers::floats);

/// Opacities beside colours: where these count to 255, and one of them is above 1, they do so too.
void decode_file_opacities(std::vector<float>& opacities, bool colors_count_to_255);

/// Tells that the colours of `n` faces have no part beside those of the vertices, which are finer.
void tell_unused_face_colors(std::size_t n, Findings& findings);

/// The opacity of a vertex to which the file gives none, in whatever it counts: mesh files' are cut off at 1.
inline constexpr float opacity_not_given = std::numeric_limits<float>::infinity();

}  // namespace lambake
