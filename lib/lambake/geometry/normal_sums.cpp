#include "lambake/geometry/normal_sums.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lambake/geometry/normal_sums.cpp"
#include <hwy/foreach_target.h>  // compiles the part below once per vector path
#include <hwy/highway.h>

#ifndef LAMBAKE_GEOMETRY_NORMAL_SUMS_ONCE
#define LAMBAKE_GEOMETRY_NORMAL_SUMS_ONCE
namespace lambake {
namespace {

/// Faces at a time: what is between the loops over them stays in the level 1 cache.
constexpr std::size_t n_in_block = 64;

/// What the faces of a block have at one corner each: x, y, z of the position, later of the weighted normal,
/// and the weight.
using Corners = float[4 * n_in_block];

/// Faces on their way from positions to weighted normals.
struct alignas(64) Block {
  Corners corners[3];
  float x[n_in_block], y[n_in_block], z[n_in_block];  // Twice the area vector, in square units.
  float unit[n_in_block];  // A power of two near the longest edge; 0 where float cannot be sure of the face.
  float terms[3][n_in_block];  // Of each corner's weight.
};

/// A sum of unit normals shorter than this share of the sum of its weights has no direction: the faces
/// cancel.
constexpr double cancelled = 1e-6;

/// Below this share of the sum of its weights, the 1e-7 by which float shares are off shows in the direction.
constexpr double uncertain = 0.25;

/// atan(z) to 1.2e-7 of itself, for z in [0,1]: Chebyshev interpolation of atan(z)/z over z².
constexpr float atan_coefficients[] = {0.999999881996f,  -0.333318126556f,  0.199669618296f,
                                       -0.140032901847f, 0.0986886545832f,  -0.0588297531472f,
                                       0.0237805186009f, -0.00455979198733f};

double corner_weight(double doubled_area, const glm::dvec3& e1, const glm::dvec3& e2, NormalWeight weight) {
  switch (weight) {
    case NormalWeight::angle:
      return std::atan2(doubled_area, glm::dot(e1, e2));
    case NormalWeight::area:
      return doubled_area;
    case NormalWeight::uniform:
      return 1;
    case NormalWeight::max:
      return doubled_area / (glm::dot(e1, e1) * glm::dot(e2, e2));
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
    const double w = corner_weight(length, next - here, last - here, weight);
    NormalSum& sum = window.sums[place];
    for (int k = 0; k < 3; ++k) sum.normal[k] += cross[k] / length * w;
    sum.weight += w;
  }
}

}  // namespace
}  // namespace lambake
#endif

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

// As many floats as there are doubles in a vector, so that the two go side by side.
using Doubles = hn::CappedTag<double, 8>;
using Floats = hn::Rebind<float, Doubles>;
using Words = hn::Rebind<std::uint32_t, Doubles>;
using D = hn::Vec<Doubles>;
using F = hn::Vec<Floats>;

template <typename V>
struct Vector3 {
  V x, y, z;
};
using F3 = Vector3<F>;
using D3 = Vector3<D>;

template <typename V>
HWY_INLINE Vector3<V> subtract(const Vector3<V>& a, const Vector3<V>& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
template <typename V>
HWY_INLINE Vector3<V> scale(const Vector3<V>& a, V s) {
  return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)};
}
template <typename V>
HWY_INLINE V dot(const Vector3<V>& a, const Vector3<V>& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
template <typename V>
HWY_INLINE Vector3<V> cross(const Vector3<V>& a, const Vector3<V>& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE D3 promote(const F3& a) {
  const Doubles d;
  return {hn::PromoteTo(d, a.x), hn::PromoteTo(d, a.y), hn::PromoteTo(d, a.z)};
}
HWY_INLINE F3 demote(const D3& a) {
  const Floats f;
  return {hn::DemoteTo(f, a.x), hn::DemoteTo(f, a.y), hn::DemoteTo(f, a.z)};
}

HWY_INLINE F3 load_corners(const float* corners) {
  F3 p;
  F unused;
  hn::LoadInterleaved4(Floats(), corners, p.x, p.y, p.z, unused);
  return p;
}

/// An angle of at most a right one by its sine and cosine, up to a factor.
HWY_INLINE F acute_angle(F y, F x) {
  const Floats f;
  const F z = hn::Div(hn::Min(y, x), hn::Max(y, x)), u = hn::Mul(z, z);
  // Estrin's scheme: short chains.
  const F u2 = hn::Mul(u, u), u4 = hn::Mul(u2, u2);
  const auto pair = [&](int i) HWY_ATTR {
    return hn::Add(hn::Set(f, atan_coefficients[i]), hn::Mul(u, hn::Set(f, atan_coefficients[i + 1])));
  };
  const F first = hn::Add(pair(0), hn::Mul(u2, pair(2))), second = hn::Add(pair(4), hn::Mul(u2, pair(6)));
  const F low = hn::Mul(z, hn::Add(first, hn::Mul(u4, second)));
  return hn::IfThenElse(hn::Gt(y, x), hn::Sub(hn::Set(f, std::numbers::pi_v<float> / 2), low), low);
}

/// The angles of triangles from twice the area and the dot products of the edges at each corner. The largest,
/// which has the least dot product, is what the others leave of π.
HWY_INLINE F3 angles(F area, F dot0, F dot1, F dot2) {
  const Floats f;
  const auto is_0_large = hn::And(hn::Le(dot0, dot1), hn::Le(dot0, dot2));
  const auto is_1_large = hn::AndNot(is_0_large, hn::Le(dot1, dot2));
  const F a = acute_angle(area, hn::IfThenElse(is_0_large, dot2, dot0));
  const F b = acute_angle(area, hn::IfThenElse(is_1_large, dot2, dot1));
  const F large = hn::Sub(hn::Set(f, std::numbers::pi_v<float>), hn::Add(a, b));
  return {hn::IfThenElse(is_0_large, large, a), hn::IfThenElse(is_1_large, large, b),
          hn::IfThenElse(is_0_large, a, hn::IfThenElse(is_1_large, b, large))};
}

/// The edges of faces, and a power of two near the longest.
struct Edges {
  F3 e1, e2;
  F longest, unit, per_unit;
};

HWY_INLINE Edges edges_of(const F3& p0, const F3& p1, const F3& p2) {
  const Floats f;
  const Words u;
  Edges edges;
  const F3 e1 = subtract(p1, p0), e2 = subtract(p2, p0);
  edges.e1 = e1, edges.e2 = e2;
  edges.longest =
      hn::Max(hn::Max(hn::Max(hn::Abs(e1.x), hn::Abs(e1.y)), hn::Max(hn::Abs(e1.z), hn::Abs(e2.x))),
              hn::Max(hn::Abs(e2.y), hn::Abs(e2.z)));
  const auto exponent = hn::And(hn::BitCast(u, edges.longest), hn::Set(u, 0x7f800000u));
  edges.unit = hn::BitCast(f, exponent);
  edges.per_unit = hn::BitCast(f, hn::Sub(hn::Set(u, 254u << 23), exponent));
  return edges;
}

/// Lanes in which `edges` are of a size, and an area vector in their units of a length, that float can
/// handle. False for what is not finite, too.
HWY_INLINE hn::Mask<Floats> is_sure(const Edges& edges, F length_squared, float least) {
  const Floats f;
  return hn::And(
      hn::Gt(length_squared, hn::Set(f, least)),
      hn::And(hn::Gt(edges.longest, hn::Set(f, 0x1p-50f)), hn::Lt(edges.longest, hn::Set(f, 0x1p50f))));
}

/// From positions to what weights are made of, for as many faces as a vector has lanes, from the one at `i`
/// on.
///
/// Edges and their cross product are in double, so that slivers keep their direction. The rest is float, in
/// units of a power of two near the longest edge.
template <NormalWeight weight>
HWY_INLINE void measure(Block& block, std::size_t i) {
  const Doubles d;
  const Floats f;
  const F3 p0 = load_corners(&block.corners[0][4 * i]), p1 = load_corners(&block.corners[1][4 * i]),
           p2 = load_corners(&block.corners[2][4 * i]);
  const D3 q0 = promote(p0);
  const D3 area_vector = cross(subtract(promote(p1), q0), subtract(promote(p2), q0));
  const Edges edges = edges_of(p0, p1, p2);
  const D per_unit = hn::PromoteTo(d, edges.per_unit);
  const F3 n = demote(scale(area_vector, hn::Mul(per_unit, per_unit)));
  hn::Store(n.x, f, block.x + i);
  hn::Store(n.y, f, block.y + i);
  hn::Store(n.z, f, block.z + i);
  hn::Store(hn::IfThenElseZero(is_sure(edges, dot(n, n), 1e-10f), edges.unit), f, block.unit + i);
  if constexpr (weight == NormalWeight::angle || weight == NormalWeight::max) {
    const F3 e1 = scale(edges.e1, edges.per_unit), e2 = scale(edges.e2, edges.per_unit);
    const F3 e3 = scale(subtract(p2, p1), edges.per_unit);
    constexpr bool is_angle = weight == NormalWeight::angle;
    hn::Store(is_angle ? dot(e1, e2) : dot(e3, e3), f, block.terms[0] + i);
    hn::Store(is_angle ? hn::Neg(dot(e1, e3)) : dot(e2, e2), f, block.terms[1] + i);
    hn::Store(is_angle ? dot(e2, e3) : dot(e1, e1), f, block.terms[2] + i);
  }
}

/// From there to weighted normals, in the place of the positions; NaN where float is not sure. Apart from
/// measure(), as the machine works on several faces at a time only where the chains of operations are short.
template <NormalWeight weight>
HWY_INLINE void weigh(Block& block, std::size_t i) {
  const Floats f;
  const F3 n = {hn::Load(f, block.x + i), hn::Load(f, block.y + i), hn::Load(f, block.z + i)};
  const F unit = hn::Load(f, block.unit + i), length = hn::Sqrt(dot(n, n));
  const F nan = hn::Set(f, std::numeric_limits<float>::quiet_NaN());
  const F3 normal =
      scale(n, hn::IfThenElse(hn::Gt(unit, hn::Zero(f)), hn::Div(hn::Set(f, 1.0f), length), nan));
  F3 w;
  if constexpr (weight == NormalWeight::uniform) {
    w.x = w.y = w.z = hn::Set(f, 1.0f);
  } else if constexpr (weight == NormalWeight::area) {
    w.x = w.y = w.z = hn::Mul(hn::Mul(length, unit), unit);
  } else {
    const F t0 = hn::Load(f, block.terms[0] + i), t1 = hn::Load(f, block.terms[1] + i),
            t2 = hn::Load(f, block.terms[2] + i);
    if constexpr (weight == NormalWeight::angle) {
      w = angles(length, t0, t1, t2);
    } else {  // Squares of the sides opposite to each corner.
      const F scaled = hn::Div(hn::Div(length, unit), unit);
      w = {hn::Div(scaled, hn::Mul(t1, t2)), hn::Div(scaled, hn::Mul(t0, t2)),
           hn::Div(scaled, hn::Mul(t0, t1))};
    }
  }
  const auto store = [&](F share, int corner) HWY_ATTR {
    hn::StoreInterleaved4(hn::Mul(normal.x, share), hn::Mul(normal.y, share), hn::Mul(normal.z, share), share,
                          f, &block.corners[corner][4 * i]);
  };
  store(w.x, 0);
  store(w.y, 1);
  store(w.z, 2);
}

/// The positions of up to a block of faces.
HWY_INLINE void gather(const glm::vec3* positions, const glm::uvec3* triangles, std::size_t n,
                       Corners* corners) {
  for (std::size_t i = 0; i < n; ++i)
    for (int c = 0; c < 3; ++c)
      std::memcpy(&corners[c][4 * i], &positions[triangles[i][c]], sizeof(glm::vec3));
}

/// Of the `n` faces, from the one at `first` on, up to a block of those that have a corner in the window.
/// @param first  moves behind the last one looked at. @returns how many there are in `block`.
HWY_INLINE std::size_t select_faces(const glm::uvec3* triangles, std::size_t n, const NormalWindow& window,
                                    std::size_t& first, glm::uvec3* block) {
  std::size_t n_selected = 0;
  for (; first < n && n_selected < n_in_block; ++first) {
    const glm::uvec3& t = triangles[first];
    const std::uint32_t nearest =
        std::min({place_in(window, t[0]), place_in(window, t[1]), place_in(window, t[2])});
    block[n_selected] = t;
    n_selected += nearest < window.sums.size();
  }
  return n_selected;
}

/// @tparam is_whole  every corner of the faces is in the window.
template <NormalWeight weight, bool is_whole>
void add_all(const glm::vec3* positions, const glm::uvec3* triangles, std::size_t n,
             const NormalWindow& window) {
  Block block{};
  glm::uvec3 selected[n_in_block];
  for (std::size_t first = 0; first < n;) {
    const glm::uvec3* faces = selected;
    std::size_t n_here;
    if constexpr (is_whole) {
      faces = triangles + first;
      n_here = std::min(n_in_block, n - first);
      first += n_here;
    } else {
      n_here = select_faces(triangles, n, window, first, selected);
    }
    gather(positions, faces, n_here, block.corners);
    for (std::size_t i = 0; i < n_here; i += hn::Lanes(Doubles())) measure<weight>(block, i);
    for (std::size_t i = 0; i < n_here; i += hn::Lanes(Doubles())) weigh<weight>(block, i);
    for (std::size_t i = 0; i < n_here; ++i) {
      const glm::uvec3& t = faces[i];
      if (std::isnan(block.corners[0][4 * i])) {
        add_face_exactly(positions, t, weight, nullptr, window);
        continue;
      }
      for (int c = 0; c < 3; ++c) {
        const std::uint32_t place = place_in(window, t[c]);
        if (!is_whole && place >= window.sums.size()) continue;
        double* const sum = window.sums[place].normal;
        float added[4];
        std::memcpy(added, &block.corners[c][4 * i], sizeof added);
        for (int k = 0; k < 4; ++k) sum[k] += double(added[k]);
      }
    }
  }
}

template <NormalWeight weight>
void add_with(const glm::vec3* positions, const glm::uvec3* triangles, std::size_t n,
              const NormalWindow& window, bool is_whole) {
  if (is_whole)
    add_all<weight, true>(positions, triangles, n, window);
  else
    add_all<weight, false>(positions, triangles, n, window);
}

void add_faces_of(const glm::vec3* positions, const glm::uvec3* triangles, std::size_t n, NormalWeight weight,
                  const NormalWindow& window, bool is_whole) {
  switch (weight) {
    case NormalWeight::angle:
      return add_with<NormalWeight::angle>(positions, triangles, n, window, is_whole);
    case NormalWeight::area:
      return add_with<NormalWeight::area>(positions, triangles, n, window, is_whole);
    case NormalWeight::uniform:
      return add_with<NormalWeight::uniform>(positions, triangles, n, window, is_whole);
    case NormalWeight::max:
      return add_with<NormalWeight::max>(positions, triangles, n, window, is_whole);
  }
}

bool have_area_of(const glm::vec3* positions, const glm::uvec3* triangles, std::size_t n) {
  const Floats f;
  HWY_ALIGN Corners corners[3];
  for (std::size_t first = 0; first < n; first += n_in_block) {
    const std::size_t n_here = std::min(n_in_block, n - first);
    // Lanes past the last face take a sound one.
    for (std::size_t i = n_here; i < n_in_block; ++i) {
      for (Corners& corner : corners) std::fill_n(&corner[4 * i], 4, 0.0f);
      corners[1][4 * i] = corners[2][4 * i + 1] = 1;
    }
    gather(positions, triangles + first, n_here, corners);
    for (std::size_t i = 0; i < n_here; i += hn::Lanes(f)) {
      const Edges edges = edges_of(load_corners(&corners[0][4 * i]), load_corners(&corners[1][4 * i]),
                                   load_corners(&corners[2][4 * i]));
      const F3 n_scaled = cross(scale(edges.e1, edges.per_unit), scale(edges.e2, edges.per_unit));
      // Far above both the rounding of float, 1e-12 here, and the least area.
      if (!hn::AllTrue(f, is_sure(edges, dot(n_scaled, n_scaled), 1e-6f))) return false;
    }
  }
  return true;
}

IndexRange range_of(const std::uint32_t* indices, std::size_t n) {
  std::uint32_t first = indices[0], last = indices[0];
  for (std::size_t i = 1; i < n; ++i) {
    first = std::min(first, indices[i]);
    last = std::max(last, indices[i]);
  }
  return {first, last};
}

UnitNormalCounts unit_normals_of(const NormalSum* sums, std::size_t n, glm::vec3* normals) {
  const Doubles d;
  const Floats f;
  const std::size_t lanes = hn::Lanes(d);
  UnitNormalCounts counts;
  for (std::size_t i = 0; i + lanes <= n; i += lanes) {
    D3 sum;
    D weight;
    hn::LoadInterleaved4(d, sums[i].normal, sum.x, sum.y, sum.z, weight);
    const D length = hn::Sqrt(dot(sum, sum));
    const auto has_direction = hn::Gt(length, hn::Mul(weight, hn::Set(d, cancelled)));
    const D reciprocal = hn::IfThenElseZero(has_direction, hn::Div(hn::Set(d, 1.0), length));
    const F3 normal = demote(scale(sum, reciprocal));
    hn::StoreInterleaved3(normal.x, normal.y, normal.z, f, &normals[i].x);
    counts.n_without += lanes - hn::CountTrue(d, has_direction);
    counts.n_uncertain += hn::CountTrue(d, hn::Lt(length, hn::Mul(weight, hn::Set(d, uncertain))));
  }
  return counts;
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
HWY_EXPORT(range_of);
HWY_EXPORT(unit_normals_of);
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

IndexRange index_range(std::span<const glm::uvec3> triangles, std::span<const std::uint32_t> group_of) {
  if (group_of.empty()) return HWY_DYNAMIC_DISPATCH(range_of)(&triangles[0].x, 3 * triangles.size());
  IndexRange range{group_of[triangles[0].x], group_of[triangles[0].x]};
  for (const glm::uvec3& t : triangles)
    for (int c = 0; c < 3; ++c) {
      range.first = std::min(range.first, group_of[t[c]]);
      range.last = std::max(range.last, group_of[t[c]]);
    }
  return range;
}

void add_faces(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
               NormalWeight weight, const NormalWindow& window, IndexRange named) {
  const bool is_whole = named.first >= window.first && named.last - window.first < window.sums.size();
  HWY_DYNAMIC_DISPATCH(add_faces_of)
  (positions.data(), triangles.data(), triangles.size(), weight, window, is_whole);
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

bool is_uncertain(const NormalSum& sum) {
  const auto& [x, y, z] = sum.normal;
  return std::sqrt(x * x + y * y + z * z) < sum.weight * uncertain;
}

UnitNormalCounts unit_normals(std::span<const NormalSum> sums, std::span<glm::vec3> normals) {
  // The rest as one vector more, filled with sums of one direction.
  constexpr std::size_t n_lanes = 8;
  const std::size_t n_whole = sums.size() / n_lanes * n_lanes;
  const auto kernel = HWY_DYNAMIC_DISPATCH(unit_normals_of);
  const UnitNormalCounts whole = kernel(sums.data(), n_whole, normals.data());
  NormalSum last_sums[n_lanes];
  glm::vec3 last_normals[n_lanes];
  std::fill(std::begin(last_sums), std::end(last_sums), NormalSum{{1, 0, 0}, 1});
  std::copy(sums.begin() + static_cast<std::ptrdiff_t>(n_whole), sums.end(), last_sums);
  const UnitNormalCounts last = kernel(last_sums, n_lanes, last_normals);
  std::copy_n(last_normals, sums.size() - n_whole, normals.begin() + static_cast<std::ptrdiff_t>(n_whole));
  return {whole.n_without + last.n_without, whole.n_uncertain + last.n_uncertain};
}

}  // namespace lambake
#endif  // HWY_ONCE
