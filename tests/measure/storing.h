#pragma once

#include "lambake/bake/color_output.h"

namespace lambake {

/// An output that keeps `stored(c)` of a colour c.
template <typename Stored>
ColorOutput storing(Stored stored) {
  ColorOutput output;
  output.shown = [stored](const LinearRgb& color, const Material& material) {
    const auto to_double = [](const LinearRgb& c) { return glm::dvec3(c.r, c.g, c.b); };
    return to_double(material.base_color) * to_double(stored(color)) + to_double(emission_of(material));
  };
  return output;
}

}  // namespace lambake
