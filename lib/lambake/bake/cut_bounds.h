#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "lambake/bake/bake.h"
#include "lambake/bake/cut_colors.h"
#include "lambake/bake/deadline.h"
#include "lambake/geometry/cutting.h"
#include "lambake/shading/finish.h"
#include "lambake/shading/patch_bound.h"

namespace lambake {

/// Certified bounds of the errors on the triangles of a mesh that is being cut; internal to the folder.
class CutBounds {
 public:
  /// The arguments must outlive it. F' is always that of `cut`.
  CutBounds(const Scene& scene, const BakeOptions& options, const CutMesh& cut, const CutColors& colors,
            const Finishes& finishes, const Deadline& deadline);

  /// F'; infinite until known.
  const std::vector<double>& values() const { return values_; }
  /// The triangles with a bound above `level`, ascending.
  std::vector<std::uint32_t> above(double level) const;

  /// Bounds of the triangles as they are now, no better than `level` needs; infinite once it is late.
  void update(std::span<const std::uint32_t> triangles, double level);
  /// Bounds near the truth, for what is told of triangles that stay open: update() leaves them where it has
  /// found an error above the level.
  void update_closely(std::span<const std::uint32_t> triangles);
  /// Makes room for the triangles that `cut` has made since the last call.
  void add_new_triangles() { values_.resize(cut_.mesh().n_triangles(), infinity); }

  /// Whether the rounding of a triangle's corners to float takes half of `level`: no cut mends that.
  bool is_rounded_too_far(std::uint32_t triangle, double level) const;

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  double bound_of(std::uint32_t triangle, BoundOptions how, std::vector<std::uint32_t>& lights) const;
  double change_by_rounding(std::uint32_t triangle, const Patch& patch, const FinishRange& finish) const;

  const Scene& scene_;
  const BakeOptions& options_;
  const CutMesh& cut_;
  const CutColors& colors_;
  const Finishes& finishes_;
  const Deadline& deadline_;
  std::vector<double> values_;
};

}  // namespace lambake
