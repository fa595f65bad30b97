#pragma once

#include "lambake/bake/bake.h"
#include "lambake/scene/scene.h"

namespace lambake {

/// What makes vertex colours in a file differ from per-pixel lighting: linear RMSEs over the surface of each
/// step alone. Their squares add up to that of the whole as far as the steps are independent.
struct ErrorShares {
  double interpolation = 0;  ///< Of the colours as computed against per-pixel lighting.
  double clipping = 0;       ///< Of colours clamped to what the storage holds against those as computed.
  double quantisation = 0;   ///< Of the colours as stored against the clamped ones.
};

/// @param baked          colours as computed.
/// @param interpolation  their linear RMSE: of surface_error(), or of surface_errors() once they are stored.
ErrorShares error_shares(const Scene& scene, const BakedColors& baked, const ColorOutput& output,
                         double interpolation);

}  // namespace lambake
