#include "lambake/geometry/normal_sums.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lambake/geometry/normal_sums.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>  // compiles the part below once per vector path
#include <hwy/highway.h>

#include "lambake/geometry/face_shares-inl.h"

#ifndef LAMBAKE_GEOMETRY_NORMAL_SUMS_ONCE
#define LAMBAKE_GEOMETRY_NORMAL_SUMS_ONCE
namespace lambake {
namespace {

/// @param unit  of the lengths in the weight.
double corner_weight(double doubled_area, const glm::dvec3& e1, const glm::dvec3& e2, NormalWeight weight,
                     double unit) {
  switch (weight) {
    case NormalWeight::angle:
      return std::atan2(doubled_area, glm::dot(e1, e2));
    case NormalWeight::area:
      return doubled_area / unit / unit;
    case NormalWeight::uniform:
      return 1;
    case NormalWeight::max:
      return doubled_area / (glm::dot(e1, e1) * glm::dot(e2, e2)) * unit * unit;
  }
  return 0;
}

/// Number of a vertex's sum among those of the window; no less than their number if it is not one of them.
inline std::uint32_t place_in(const NormalWindow& window, std::uint32_t v) {
  return (window.group_of.empty() ? v : window.group_of[v]) - window.first;
}

/// What one face adds, by the equations as one reads them: where float does not do.
/// @param is_wanted  by sum; null: all are.
void add_face_exactly(const glm::vec3* positions, const glm::uvec3& t, NormalWeight weight,
                      const char* is_wanted, const NormalWindow& window) {
  const glm::dvec3 p[3] = {glm::dvec3(positions[t[0]]), glm::dvec3(positions[t[1]]),
                           glm::dvec3(positions[t[2]])};
  const glm::dvec3 cross = area_vector(positions[t[0]], positions[t[1]], positions[t[2]]);
  const double length = glm::length(cross);
  if (!(length > 0)) return;
  for (int c = 0; c < 3; ++c) {
    const std::uint32_t place = place_in(window, t[c]);
    if (place >= window.sums.size() || (is_wanted != nullptr && is_wanted[place] == 0)) continue;
    const glm::dvec3 &here = p[c], &next = p[(c + 1) % 3], &last = p[(c + 2) % 3];
    const double w = corner_weight(length, next - here, last - here, weight, window.unit);
    NormalSum& sum = window.sums[place];
    for (int k = 0; k < 3; ++k) sum.values[k] += cross[k] / length * w;
    sum.values[3] += w;
  }
}

}  // namespace
}  // namespace lambake
#endif

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Numbers = hn::ScalableTag<std::uint32_t>;
using N = hn::Vec<Numbers>;

/// Of the numbers that each lane of a vector has seen.
struct LaneRanges {
  N least, greatest;

  HWY_INLINE void add(const N& least_here, const N& greatest_here) {
    least = hn::Min(least, least_here);
    greatest = hn::Max(greatest, greatest_here);
  }
  HWY_INLINE IndexRange together() const {
    const Numbers u;
    return {hn::GetLane(hn::MinOfLanes(u, least)), hn::GetLane(hn::MaxOfLanes(u, greatest))};
  }
  /// True if all are in [first, end), which must not be empty.
  HWY_INLINE bool are_within(std::size_t first, std::size_t end) const {
    const Numbers u;
    const auto last = hn::Set(u, static_cast<std::uint32_t>(end - 1));
    const auto outside =
        hn::Or(hn::Lt(least, hn::Set(u, static_cast<std::uint32_t>(first))), hn::Gt(greatest, last));
    return hn::AllFalse(u, outside);
  }
};

HWY_INLINE LaneRanges no_ranges() {
  return {hn::Set(Numbers(), std::numeric_limits<std::uint32_t>::max()), hn::Zero(Numbers())};
}

/// @param faces  a whole block.
HWY_INLINE LaneRanges ranges_of(const glm::uvec3* faces) {
  const Numbers u;
  LaneRanges ranges = no_ranges();
  for (std::size_t i = 0; i < 3 * n_in_block; i += hn::Lanes(u)) {
    const N here = hn::LoadU(u, &faces->x + i);
    ranges.add(here, here);
  }
  return ranges;
}

/// How many faces ahead memory is asked for them.
constexpr std::size_t n_ahead = 4 * n_in_block;
constexpr std::size_t cache_line = 16;  // In numbers of 4 bytes.

/// What add_block() works in.
struct Scratch {
  Block block;
  CopiedFaces copied;
};

/// Adds up to a block of faces. @param faces  as many more as fill a vector may be read.
/// @param groups    that each of the faces names.
/// @param is_whole  all of these are in the window.
/// @param has_next  the faces do not name the last vertex.
template <NormalWeight weight>
void add_block(const glm::vec3* positions, const glm::uvec3* faces, const glm::uvec3* groups, std::size_t n,
               const NormalWindow& window, bool is_whole, bool has_next, Scratch& scratch) {
  // Copies: the sums might overwrite what `window` refers to, for all that the compiler knows.
  NormalSum* const sums = window.sums.data();
  const std::size_t first_group = window.first, n_sums = window.sums.size();
  Block& block = scratch.block;
  const float per_unit = 1 / window.unit;
  bool are_sure;
  if (has_next) {
    are_sure = compute<weight>(positions, faces, n, per_unit, block);
  } else {
    scratch.copied.copy(positions, faces, n);
    are_sure = compute<weight>(scratch.copied.positions, scratch.copied.faces, n, per_unit, block);
  }
  // Where the sum of group 0 would be: a group's sum is found in an operation less.
  const std::uintptr_t sum_0 = reinterpret_cast<std::uintptr_t>(sums) - first_group * sizeof(NormalSum);
  const auto add_face = [&](std::size_t i, auto is_all) HWY_ATTR {
    const auto add = [&](std::uint32_t group, const Row& row) HWY_ATTR {
      if (is_all || group - first_group < n_sums)
        add_row(row, *reinterpret_cast<NormalSum*>(sum_0 + group * sizeof(NormalSum)));
    };
    const glm::uvec3& g = groups[i];
    const Row normal = load_row(block.normals + 4 * i);
    if constexpr (has_one_share(weight)) {
      add(g.x, normal), add(g.y, normal), add(g.z, normal);
    } else {
      const Row weights = load_row(block.weights + 4 * i);
      add(g.x, times_weight<0>(normal, weights));
      add(g.y, times_weight<1>(normal, weights));
      add(g.z, times_weight<2>(normal, weights));
    }
  };
  if (are_sure && is_whole) {
    for (std::size_t i = 0; i < n; ++i) add_face(i, std::true_type());
  } else if (are_sure) {
    for (std::size_t i = 0; i < n; ++i) add_face(i, std::false_type());
  } else {
    for (std::size_t i = 0; i < n; ++i)
      if (std::isnan(block.normals[4 * i]))
        add_face_exactly(positions, faces[i], weight, nullptr, window);
      else
        add_face(i, std::false_type());
  }
}

/// Faces picked from blocks that leave the window, until they fill one.
struct Picked {
  glm::uvec3 faces[n_in_block], groups[n_in_block];
  std::size_t n = 0;
  bool name_last_vertex = false;
};

/// @returns the range of the groups that the faces name.
template <NormalWeight weight, bool is_grouped>
IndexRange add_all(const glm::vec3* positions, std::size_t n_positions, const glm::uvec3* triangles,
                   std::size_t n, const NormalWindow& window) {
  Scratch scratch;
  Picked picked;
  const auto add_picked = [&] {
    if (picked.n == 0) return;
    std::fill(picked.faces + picked.n, std::end(picked.faces), picked.faces[picked.n - 1]);
    add_block<weight>(positions, picked.faces, is_grouped ? picked.groups : picked.faces, picked.n, window,
                      false, !picked.name_last_vertex, scratch);
    picked.n = 0;
    picked.name_last_vertex = false;
  };
  glm::uvec3 last_block[n_in_block], group_numbers[is_grouped ? n_in_block : 1];
  const std::size_t n_sums = window.sums.size(), end = window.first + n_sums;
  LaneRanges of_all = no_ranges();
  for (std::size_t first = 0; first < n; first += n_in_block) {
    const std::size_t n_here = std::min(n_in_block, n - first);
    const glm::uvec3* faces = triangles + first;
    for (std::size_t i = 0; i < 3 * n_in_block; i += cache_line) hwy::Prefetch(&faces->x + 3 * n_ahead + i);
    if (n_here < n_in_block) {
      std::fill(std::copy_n(faces, n_here, last_block), std::end(last_block), faces[n_here - 1]);
      faces = last_block;
    }
    const glm::uvec3* groups = faces;
    const LaneRanges vertices = ranges_of(faces);
    LaneRanges named = vertices;
    if constexpr (is_grouped) {
      const std::span<const std::uint32_t> of = window.group_of;
      for (std::size_t i = 0; i < n_in_block; ++i)
        group_numbers[i] = {of[faces[i].x], of[faces[i].y], of[faces[i].z]};
      groups = group_numbers;
      named = ranges_of(groups);
    }
    of_all.add(named.least, named.greatest);
    const bool has_next = n_positions > 1 && vertices.are_within(0, n_positions - 1);
    if (n_here == n_in_block && named.are_within(window.first, end)) {
      add_picked();
      add_block<weight>(positions, faces, groups, n_here, window, true, has_next, scratch);
      continue;
    }
    const IndexRange range = named.together();
    if (range.last < window.first || range.first >= end) continue;
    for (std::size_t i = 0; i < n_here; ++i) {
      const glm::uvec3 g = groups[i];
      picked.faces[picked.n] = faces[i];
      if constexpr (is_grouped) picked.groups[picked.n] = g;
      picked.n += std::min({g.x - window.first, g.y - window.first, g.z - window.first}) < n_sums;
      picked.name_last_vertex |= !has_next;
      if (picked.n == n_in_block) add_picked();
    }
  }
  add_picked();
  return of_all.together();
}

template <NormalWeight weight>
IndexRange add_with(const glm::vec3* positions, std::size_t n_positions, const glm::uvec3* triangles,
                    std::size_t n, const NormalWindow& window) {
  const auto add = window.group_of.empty() ? add_all<weight, false> : add_all<weight, true>;
  return add(positions, n_positions, triangles, n, window);
}

IndexRange add_faces_of(const glm::vec3* positions, std::size_t n_positions, const glm::uvec3* triangles,
                        std::size_t n, NormalWeight weight, const NormalWindow& window) {
  switch (weight) {
    case NormalWeight::angle:
      return add_with<NormalWeight::angle>(positions, n_positions, triangles, n, window);
    case NormalWeight::area:
      return add_with<NormalWeight::area>(positions, n_positions, triangles, n, window);
    case NormalWeight::uniform:
      return add_with<NormalWeight::uniform>(positions, n_positions, triangles, n, window);
    case NormalWeight::max:
      return add_with<NormalWeight::max>(positions, n_positions, triangles, n, window);
  }
  return {};
}

bool have_area_of(const glm::vec3* positions, const glm::uvec3* triangles, std::size_t n_triangles) {
  const Floats f;
  CopiedFaces copied;
  for (std::size_t first = 0; first < n_triangles; first += n_in_block) {
    const std::size_t n_here = std::min(n_in_block, n_triangles - first);
    copied.copy(positions, triangles + first, n_here);
    for (std::size_t i = 0; i < n_here; i += hn::Lanes(f)) {
      const F3 p0 = load_corners(copied.positions, &copied.faces[i].x);
      const F3 e1 = subtract(load_corners(copied.positions, &copied.faces[i].y), p0),
               e2 = subtract(load_corners(copied.positions, &copied.faces[i].z), p0), n = cross(e1, e2);
      // Far above both the rounding of float, 1e-13 here, and the least area.
      const F edges = hn::Add(dot(e1, e1), dot(e2, e2)), square = dot(n, n);
      const auto is_sure = hn::And(hn::Gt(square, hn::Mul(hn::Mul(edges, hn::Set(f, 1e-6f)), edges)),
                                   hn::And(hn::Gt(square, hn::Set(f, least_length * least_length)),
                                           hn::Lt(square, hn::Set(f, greatest_length * greatest_length))));
      if (!hn::AllTrue(f, is_sure)) return false;
    }
  }
  return true;
}

}  // namespace
}  // namespace lambake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lambake {

static_assert(sizeof(glm::vec3) == 3 * sizeof(float) && sizeof(glm::uvec3) == 3 * sizeof(std::uint32_t) &&
              sizeof(NormalSum) == 4 * sizeof(double));

namespace {
HWY_EXPORT(add_faces_of);
HWY_EXPORT(have_area_of);
}  // namespace

glm::dvec3 area_vector(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::dvec3 p0(a), p1(b), p2(c);
  const glm::dvec3 e1 = p1 - p0, e2 = p2 - p0, e3 = p2 - p1;
  const glm::dvec3 cross = glm::cross(e1, e2);
  const double longest = std::max({glm::dot(e1, e1), glm::dot(e2, e2), glm::dot(e3, e3)});
  return glm::dot(cross, cross) > 1e-24 * (longest * longest) ? cross : glm::dvec3(0);
}

bool have_area(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles) {
  return HWY_DYNAMIC_DISPATCH(have_area_of)(positions.data(), triangles.data(), triangles.size());
}

IndexRange add_faces(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                     NormalWeight weight, const NormalWindow& window) {
  return HWY_DYNAMIC_DISPATCH(add_faces_of)(positions.data(), positions.size(), triangles.data(),
                                            triangles.size(), weight, window);
}

void add_faces_exactly(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                       NormalWeight weight, const NormalWindow& window, std::span<const char> is_wanted) {
  const auto is_named = [&](std::uint32_t v) {
    const std::uint32_t place = place_in(window, v);
    return place < window.sums.size() && is_wanted[place] != 0;
  };
  for (const glm::uvec3& t : triangles)
    if (is_named(t.x) || is_named(t.y) || is_named(t.z))
      add_face_exactly(positions.data(), t, weight, is_wanted.data(), window);
}

}  // namespace lambake
#endif  // HWY_ONCE
