#include "lambake/io/file_color.h"

#include <algorithm>

namespace lambake {

bool decode_file_colors(std::vector<LinearRgb>& colors, Findings& findings, ChannelNumbers numbers) {
  std::size_t n_non_finite = 0, n_outside = 0;
  float largest = 0;
  for (LinearRgb& c : colors) {
    if (!is_finite(c)) {
      ++n_non_finite;
      continue;
    }
    largest = std::max({largest, c.r, c.g, c.b});
  }
  const bool counts_to_255 = numbers == ChannelNumbers::floats && largest > 2;
  const float scale = counts_to_255 ? 1.0f / 255.0f : 1.0f;
  // Neighbours often have the same colour, and the curve is dear.
  LinearRgb last_encoded{0, 0, 0}, last_linear{0, 0, 0};
  bool is_last_outside = false;
  for (LinearRgb& c : colors) {
    if (!is_finite(c)) {
      c = {1, 1, 1};
      continue;
    }
    if (c == last_encoded) {
      c = last_linear;
      n_outside += is_last_outside;
      continue;
    }
    last_encoded = c;
    const LinearRgb scaled = c * scale;
    const auto decode = [](float channel) { return srgb_decode(std::clamp(channel, 0.0f, 1.0f)); };
    c = last_linear = {decode(scaled.r), decode(scaled.g), decode(scaled.b)};
    is_last_outside =
        std::min({scaled.r, scaled.g, scaled.b}) < 0 || std::max({scaled.r, scaled.g, scaled.b}) > 1;
    n_outside += is_last_outside;
  }
  add_finding(findings, "non_finite_colors", n_non_finite, "colour[ is|s are] not finite; white instead");
  add_finding(findings, "colors_out_of_range", n_outside, "colour[ lies|s lie] outside of [0,1]; clamped");
  if (counts_to_255)
    add_finding(findings, "colors_to_255", colors.size(),
                "colour[ is|s are] given as floats above 2; taken to count to 255");
  return counts_to_255;
}

void decode_file_opacities(std::vector<float>& opacities, bool colors_count_to_255) {
  const auto is_above_one = [](float opacity) { return opacity > 1 && opacity != opacity_not_given; };
  if (!colors_count_to_255 || std::none_of(opacities.begin(), opacities.end(), is_above_one)) return;
  for (float& opacity : opacities) opacity /= 255.0f;
}

void tell_unused_face_colors(std::size_t n, Findings& findings) {
  add_finding(findings, "unused_face_colors", n,
              "face[ has|s have] a colour that is not used, as the vertices have some");
}

}  // namespace lambake
