#pragma once

#include <cstddef>

#include "lambake/bake/bake.h"
#include "lambake/render/visibility.h"
#include "lambake/scene/picture.h"
#include "lambake/scene/scene.h"

namespace lambake {

/// Pixels that no triangle covers.
inline constexpr LinearRgb background{0.0f, 0.0f, 0.0f};

/// The reference: at each covered pixel position, normal (renormalised) and base colour are interpolated,
/// textures sampled, and the equation is evaluated. `visibility` is of the scene's own mesh.
/// @throws InvalidScene if that has no normals.
Picture shade_per_fragment(const Scene& scene, const Visibility& visibility);

/// Gouraud: baked colours interpolated, times the material's base colour and texture, plus its emission if
/// that is not hidden.
/// `visibility` is of mesh_of(scene, baked).
/// @throws InvalidScene if that has not as many vertices as `baked` has colours.
Picture shade_per_vertex(const Scene& scene, const BakedColors& baked, const Visibility& visibility);

/// The same pictures, to the bit, from the camera on: each tile is lit while it is in cache who is seen
/// there. For who needs one picture and not the visibility. `out` takes the picture, and its memory is used
/// again. Errors as of find_visibility() and of those above. Returns the number of covered pixels.
std::size_t render_per_fragment(const Scene& scene, const Camera& camera, std::uint32_t width,
                                std::uint32_t height, Picture& out);
std::size_t render_per_vertex(const Scene& scene, const BakedColors& baked, const Camera& camera,
                              std::uint32_t width, std::uint32_t height, Picture& out);

/// Covered pixels whose triangle is seen from the side that its normal is not on.
std::size_t count_seen_from_behind(const Scene& scene, const Visibility& visibility, const Camera& camera);

}  // namespace lambake
