#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "lambake/bake/bake.h"
#include "lambake/scene/scene.h"

namespace lambake {

/// A place on the surface.
struct SurfacePlace {
  std::uint32_t triangle = 0;     ///< Of the mesh that carries the colours.
  std::uint32_t source_face = 0;  ///< The file's face.
  glm::dvec3 barycentrics{1, 0, 0};
  glm::dvec3 position{0};                ///< World space.
  double error = 0;                      ///< |G − F| of the worst channel.
  std::optional<std::uint32_t> light{};  ///< The light that contributes most to it; none where none reaches.
};

/// The difference of per-vertex and per-fragment light as a function on the surface, by area; no camera in
/// it. F is the equation on the scene's mesh with interpolated, renormalised normals; G the interpolated
/// colours.
struct SurfaceError {
  double rmse = 0, mae = 0, mean = 0;  ///< Area means over the three channels; mean is signed, G − F.
  double max_sampled = 0;  ///< Largest |G − F| met while integrating: never above the truth's maximum.
  double area = 0;         ///< Area integrated over, in squared world units.
  std::vector<float> triangle_worst;  ///< F': G − F, signed, where it is largest, of the worst channel.
  std::vector<SurfacePlace> worst;    ///< At most 8, in different triangles, largest first.
};

/// @param baked  of `scene`. @param space linear, or display (sRGB-encoded, clamped to [0,1]).
/// Adaptive quadrature; deterministic for any number of threads.
/// @throws InvalidScene if `baked` does not fit the scene, or the scene has no normals.
SurfaceError surface_error(const Scene& scene, const BakedColors& baked, ErrorSpace space);

/// What a comparison tells of stored colours.
struct SurfaceErrors {
  SurfaceError linear, display;
  double computed_rmse = 0;  ///< Linear, of the colours as computed.
};

/// The same in both spaces, and the RMSE of the colours before they were stored, with all emission, from one
/// integration: per place one evaluation of F. Parts are as fine as each of the three needs.
/// @param baked     with the colours as stored.
/// @param computed  V' colours.
/// @throws InvalidScene if there are not as many as stored ones.
SurfaceErrors surface_errors(const Scene& scene, const BakedColors& baked,
                             const std::vector<LinearRgb>& computed);

}  // namespace lambake
