#pragma once

#include "lambake/bake/bake.h"
#include "lambake/render/visibility.h"
#include "lambake/scene/scene.h"

namespace lambake {

/// The same hits in terms of the scene's own triangles: those that the seen ones were cut from, and where in
/// them the pixels are. So one visibility serves both pictures: two of one surface, found apart, see
/// different triangles where rounding decides, at folds and silhouettes.
/// @param seen  of mesh_of(scene, baked).
/// @throws InvalidScene if `baked` was not cut from the scene's mesh.
Visibility parent_hits(const Scene& scene, const BakedColors& baked, Visibility seen);

}  // namespace lambake
