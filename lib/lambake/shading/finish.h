#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lambake/scene/scene.h"
#include "lambake/shading/patch.h"

namespace lambake {

/// The finish of a triangle where it varies: the base colour and the emission, each between two values.
struct FinishRange {
  glm::dvec3 base_low{1.0}, base_high{1.0}, emission_low{0.0}, emission_high{0.0};
  bool is_unlit = false;
};

/// The colours between which a texture lies.
struct TexelRange {
  glm::dvec3 low{1.0}, high{1.0};
};

/// Where the corners of a triangle read a texture, in texels; all 0 where there is none.
struct TexelCorners {
  std::array<glm::dvec2, 3> at{};
  glm::dvec2 rounding{0.0};  ///< How far off float coordinates of a corner may be.
  bool is_nearest = false;
};

/// Base colours, emissions and textures of a scene's materials, on any mesh that uses them. The scene must
/// outlive it.
class Finishes {
 public:
  explicit Finishes(const Scene& scene);
  Finish at(const Mesh& mesh, std::size_t triangle, const glm::dvec3& b) const;
  /// All values that at() has on the triangle lie between these.
  FinishRange over(const Mesh& mesh, std::size_t triangle) const;
  /// Of the base colour and of the emission.
  std::array<TexelCorners, 2> texel_corners(const Mesh& mesh, std::size_t triangle) const;
  /// Whether at() varies over the triangle.
  bool has_texture(const Mesh& mesh, std::size_t triangle) const;

 private:
  glm::dvec3 texel_at(std::uint32_t texture, const Mesh& mesh, std::size_t triangle,
                      const glm::dvec3& b) const;
  TexelRange texels_over(std::uint32_t texture, const Mesh& mesh, std::size_t triangle) const;

  const Scene& scene_;
  std::vector<TexelRange> whole_ranges_;  ///< One per texture.
};

}  // namespace lambake
