#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "lambake/core/color.h"
#include "lambake/core/finding.h"
#include "lambake/scene/scene.h"

namespace lambake {

struct BakedColors;

/// What an output makes of vertex colours, so that what is certified is what it shows. Writers know
/// (gltf_output(), ply_output()); empty it is an output that holds everything as it is.
struct ColorOutput {
  /// What shows of a vertex of a baked colour and a material, but for textures: base colour ⊗ color +
  /// emission, as far as it is not clipped or rounded. Light that cannot be written at all (see `gaps`) is in
  /// it. Empty: exactly that.
  std::function<glm::dvec3(const LinearRgb& color, const Material& material)> shown{};
  /// Whether a material's emission cannot be written. Empty: all can.
  std::function<bool(const Material& material)> hides_emission{};
  /// Why nothing can be certified of what the output shows, whatever the colours are; none if it can.
  Findings gaps{};
};

/// The colour c for which base colour ⊗ c + emission is what the output shows of `color`. Channels without a
/// base colour stay as they are: see errors_without_light().
LinearRgb as_stored(const ColorOutput& output, const LinearRgb& color, const Material& material);

/// as_stored() of the darkest and the brightest that the output can hold; ±1e30 where it has no end.
struct ColorRange {
  LinearRgb low, high;
};
ColorRange stored_range(const ColorOutput& output, const Material& material);

/// For each of the scene's materials whether its emission cannot be written; empty if all can. For
/// BakedColors::hidden_emission.
std::vector<bool> hidden_emission(const Scene& scene, const ColorOutput& output);

/// Makes the colours what the output shows of them.
void take_stored_colors(const Scene& scene, const ColorOutput& output, BakedColors& baked);

/// For each of the scene's materials how far the emission alone is off in the output, in the channels where
/// the base colour is 0, so that no vertex colour has a part in it. 0 for materials of no triangle.
std::vector<double> errors_without_light(const Scene& scene, const ColorOutput& output, ErrorSpace space);

/// The largest difference that the output can show if that of the stored colours is at most `bound`: infinite
/// where it has gaps.
double bound_in_output(const Scene& scene, const ColorOutput& output, ErrorSpace space, double bound);

}  // namespace lambake
