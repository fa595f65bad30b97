#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lambake/bake/bake.h"
#include "lambake/bake/cut_bounds.h"
#include "lambake/bake/cut_colors.h"
#include "lambake/bake/deadline.h"
#include "lambake/bake/side_error.h"
#include "lambake/geometry/cutting.h"
#include "lambake/shading/finish.h"

namespace lambake {

/// Where to cut a mesh so that errors on it fall below a level; internal to the folder.
class CutSearch {
 public:
  /// The arguments must outlive it.
  CutSearch(const Scene& scene, const BakeOptions& options, const CutMesh& cut, const CutColors& colors,
            const Finishes& finishes, const CutBounds& bounds, const Deadline& deadline);

  /// For the triangles of `active` that are above `level`: every side with an error above it, which no other
  /// cut can mend, or else the worst side. With `is_thorough` also those whose error bulges by half of it:
  /// spared sides of needles can leave cuts beside them without effect.
  std::vector<CutMark> find_marks(std::span<const std::uint32_t> active, double level, bool is_thorough);

  /// False once find_marks() has left out cuts for which there may be no more vertices.
  bool has_room() const { return has_room_; }

  /// The error along the side between the vertices a and b; t from the lower place to the higher.
  SideError error_between(std::uint32_t a, std::uint32_t b, const FinishRange& finish) const;

 private:
  /// A side that may be cut, by the places of its ends, and its error.
  struct Candidate {
    std::uint32_t low = 0, high = 0;
    double error = 0, t = 0;
  };
  void add_candidates(std::uint32_t triangle, double level, bool is_thorough,
                      std::vector<Candidate>& candidates) const;
  std::vector<std::size_t> vertices_made(const std::vector<Candidate>& candidates) const;
  void keep_what_has_room(std::vector<Candidate>& candidates);
  double bend(std::uint32_t a, std::uint32_t b) const;

  const Scene& scene_;
  const CutMesh& cut_;
  const CutColors& colors_;
  const Finishes& finishes_;
  const CutBounds& bounds_;
  const Deadline& deadline_;
  ErrorSpace space_;
  std::size_t max_vertices_;
  double shortest_side_;
  bool has_room_ = true;
};

}  // namespace lambake
