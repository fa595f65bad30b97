#include "lambake/io/color_storage.h"

#include <fmt/format.h>

#include <cmath>

namespace lambake {

float brightest_of(std::span<const LinearRgb> colors) {
  float brightest = 0;
  for (const LinearRgb& c : colors)
    for (const float channel : {c.r, c.g, c.b})
      if (std::isfinite(channel)) brightest = std::max(brightest, channel);
  return brightest;
}

std::string exposure_to_white(float brightest) {
  const int stops = std::max(1, static_cast<int>(std::ceil(std::log2(std::max(brightest, 1.0f)))));
  return fmt::format("an exposure lower by {} stop{}", stops, stops == 1 ? "" : "s");
}

void tell_storage(Findings& findings, const StorageLosses& losses) {
  add_finding(findings, "clipped_vertices", losses.n_above,
              "vert[ex is|ices are] brighter than a vertex colour can hold; clipped to 1 (" +
                  exposure_to_white(losses.brightest) + " avoids it)");
  add_finding(findings, "negative_vertices", losses.n_below,
              "vert[ex has|ices have] a colour below 0; stored as 0");
}

}  // namespace lambake
