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
  float x[n_in_block], y[n_in_block], z[n_in_block];  // Twice the area vector; NaN where there may be none.
  float terms[3][n_in_block];                         // Of each corner's weight. All in units of the window.
  float is_sliver[n_in_block];                        // 0 or 1.
  float length[n_in_block];                           // Of the area vector.
  float angles[2 * n_in_block];  // The two smaller ones of each face, in the order of the corners.
};

/// Lengths of area vectors between which squares neither overflow float nor run dry: of edges between 1e-8
/// and 1e8 units.
constexpr float least_length = 1e-17f, greatest_length = 1e17f;

/// Squared sine between two edges below which a face is measured in double: the area vector of float is off
/// by some 1e-7 of the product of the edges.
constexpr float sliver = 0.0625f;

/// atan(z) to 1.2e-7 of itself, for z in [0,1]: Chebyshev interpolation of atan(z)/z over z².
constexpr float atan_coefficients[] = {0.999999881996f,  -0.333318126556f,  0.199669618296f,
                                       -0.140032901847f, 0.0986886545832f,  -0.0588297531472f,
                                       0.0237805186009f, -0.00455979198733f};

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

using Floats = hn::CappedTag<float, 8>;
using F = hn::Vec<Floats>;
// As many floats as there are doubles in a vector, so that the two go side by side.
using Doubles = hn::CappedTag<double, 8>;
using FewFloats = hn::Rebind<float, Doubles>;
using D = hn::Vec<Doubles>;

template <typename V>
struct Vector3 {
  V x, y, z;
};
using F3 = Vector3<F>;
using D3 = Vector3<D>;
using FewF3 = Vector3<hn::Vec<FewFloats>>;

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
HWY_INLINE D3 promote(const FewF3& a) {
  const Doubles d;
  return {hn::PromoteTo(d, a.x), hn::PromoteTo(d, a.y), hn::PromoteTo(d, a.z)};
}
template <typename Tag>
HWY_INLINE Vector3<hn::Vec<Tag>> load_corners(Tag tag, const float* corners) {
  Vector3<hn::Vec<Tag>> p;
  hn::Vec<Tag> unused;
  hn::LoadInterleaved4(tag, corners, p.x, p.y, p.z, unused);
  return p;
}

template <NormalWeight weight, typename Tag>
HWY_INLINE void store_measured(Tag tag, const Vector3<hn::Vec<Tag>>& n, const Vector3<hn::Vec<Tag>>& terms,
                               Block& block, std::size_t i) {
  hn::Store(n.x, tag, block.x + i);
  hn::Store(n.y, tag, block.y + i);
  hn::Store(n.z, tag, block.z + i);
  if constexpr (weight == NormalWeight::angle || weight == NormalWeight::max) {
    hn::Store(terms.x, tag, block.terms[0] + i);
    hn::Store(terms.y, tag, block.terms[1] + i);
    hn::Store(terms.z, tag, block.terms[2] + i);
  }
}

/// measure() for slivers, in double.
template <NormalWeight weight>
HWY_INLINE void measure_slivers(Block& block, std::size_t i, float per_unit) {
  const Doubles d;
  const FewFloats f;
  const auto is_sliver = hn::Gt(hn::Load(f, block.is_sliver + i), hn::Zero(f));
  if (hn::AllFalse(f, is_sliver)) return;
  const D3 p0 = promote(load_corners(f, &block.corners[0][4 * i])),
           p1 = promote(load_corners(f, &block.corners[1][4 * i])),
           p2 = promote(load_corners(f, &block.corners[2][4 * i]));
  const D per = hn::Set(d, double(per_unit));
  const D3 e1 = scale(subtract(p1, p0), per), e2 = scale(subtract(p2, p0), per),
           e3 = scale(subtract(p2, p1), per), n = cross(e1, e2);
  const D edges = hn::Add(dot(e1, e1), dot(e2, e2));
  const auto has_area = hn::Gt(dot(n, n), hn::Mul(hn::Set(d, 1e-20), hn::Mul(edges, edges)));
  const D one =
      hn::IfThenElse(has_area, hn::Set(d, 1.0), hn::Set(d, std::numeric_limits<double>::quiet_NaN()));
  const auto merge = [&](D exact, const float* stored) HWY_ATTR {
    return hn::IfThenElse(is_sliver, hn::DemoteTo(f, exact), hn::Load(f, stored + i));
  };
  const FewF3 area = {merge(hn::Mul(n.x, one), block.x), merge(n.y, block.y), merge(n.z, block.z)};
  FewF3 terms = area;
  if constexpr (weight == NormalWeight::angle)
    terms = {merge(dot(e1, e2), block.terms[0]), merge(hn::Neg(dot(e1, e3)), block.terms[1]),
             merge(dot(e2, e3), block.terms[2])};
  if constexpr (weight == NormalWeight::max)
    terms = {merge(dot(e3, e3), block.terms[0]), merge(dot(e2, e2), block.terms[1]),
             merge(dot(e1, e1), block.terms[2])};
  store_measured<weight>(f, area, terms, block, i);
}

/// From positions to area vectors and what weights are made of (the dot products of the edges at each corner
/// for angles; the squares of the sides opposite for `max`), for as many faces as a vector has lanes, from
/// the one at `i` on.
template <NormalWeight weight>
HWY_INLINE void measure(Block& block, std::size_t i, float per_unit) {
  const Floats f;
  const F3 p0 = load_corners(f, &block.corners[0][4 * i]), p1 = load_corners(f, &block.corners[1][4 * i]),
           p2 = load_corners(f, &block.corners[2][4 * i]);
  const F per = hn::Set(f, per_unit);
  const F3 e1 = scale(subtract(p1, p0), per), e2 = scale(subtract(p2, p0), per), n = cross(e1, e2);
  const F square1 = dot(e1, e1), square2 = dot(e2, e2);
  F3 terms = n;
  if constexpr (weight == NormalWeight::angle) {
    const F cosine = dot(e1, e2);
    terms = {cosine, hn::Sub(square1, cosine), hn::Sub(square2, cosine)};
  }
  if constexpr (weight == NormalWeight::max) {
    const F3 e3 = scale(subtract(p2, p1), per);
    terms = {dot(e3, e3), square2, square1};
  }
  store_measured<weight>(f, n, terms, block, i);
  const auto is_plain = hn::Gt(dot(n, n), hn::Mul(hn::Mul(square1, hn::Set(f, sliver)), square2));
  if (hn::AllTrue(f, is_plain)) return;
  hn::Store(hn::IfThenZeroElse(is_plain, hn::Set(f, 1.0f)), f, block.is_sliver + i);
  for (std::size_t k = 0; k < hn::Lanes(f); k += hn::Lanes(Doubles()))
    measure_slivers<weight>(block, i + k, per_unit);
}

/// Which corner of faces has the largest angle, if it is not the last: by the dot products of the edges
/// there.
struct Largest {
  hn::Mask<Floats> is_0, is_1;
};

HWY_INLINE Largest largest_of(const F3& cosines) {
  const auto is_0 = hn::And(hn::Le(cosines.x, cosines.y), hn::Le(cosines.x, cosines.z));
  return {is_0, hn::AndNot(is_0, hn::Le(cosines.y, cosines.z))};
}

HWY_INLINE F3 load_terms(const Block& block, std::size_t i) {
  const Floats f;
  return {hn::Load(f, block.terms[0] + i), hn::Load(f, block.terms[1] + i), hn::Load(f, block.terms[2] + i)};
}

/// Sine over cosine, or cosine over sine with the sign turned where that is below 1: for arctangents().
HWY_INLINE F ratio(F sine, F cosine) {
  const F z = hn::Div(hn::Min(sine, cosine), hn::Max(sine, cosine));
  return hn::IfThenElse(hn::Gt(sine, cosine), hn::Neg(z), z);
}

/// The lengths of area vectors and, for angles, the ratios of the two smaller ones.
template <NormalWeight weight>
HWY_INLINE void find_lengths(Block& block, std::size_t i) {
  const Floats f;
  const F3 n = {hn::Load(f, block.x + i), hn::Load(f, block.y + i), hn::Load(f, block.z + i)};
  const F length = hn::Sqrt(dot(n, n));
  hn::Store(length, f, block.length + i);
  if constexpr (weight == NormalWeight::angle) {
    const F3 t = load_terms(block, i);
    const Largest largest = largest_of(t);
    hn::Store(ratio(length, hn::IfThenElse(largest.is_0, t.z, t.x)), f, block.angles + i);
    hn::Store(ratio(length, hn::IfThenElse(largest.is_1, t.z, t.y)), f, block.angles + n_in_block + i);
  }
}

/// Angles of at most a right one from what ratio() gives, in its place.
HWY_INLINE void arctangents(float* angles) {
  const Floats f;
  const F z = hn::Load(f, angles), u = hn::Mul(z, z);
  // Estrin's scheme: short chains.
  const F u2 = hn::Mul(u, u), u4 = hn::Mul(u2, u2);
  const auto pair = [&](int i) HWY_ATTR {
    return hn::Add(hn::Set(f, atan_coefficients[i]), hn::Mul(u, hn::Set(f, atan_coefficients[i + 1])));
  };
  const F first = hn::Add(pair(0), hn::Mul(u2, pair(2))), second = hn::Add(pair(4), hn::Mul(u2, pair(6)));
  const F low = hn::Mul(z, hn::Add(first, hn::Mul(u4, second)));
  const hn::RebindToSigned<Floats> s;
  const F is_negative = hn::BitCast(f, hn::BroadcastSignBit(hn::BitCast(s, low)));  // Of -0 too.
  hn::Store(hn::Add(low, hn::And(is_negative, hn::Set(f, std::numbers::pi_v<float> / 2))), f, angles);
}

template <NormalWeight weight>
HWY_INLINE F3 weights_of(const Block& block, std::size_t i, F length) {
  const Floats f;
  if constexpr (weight == NormalWeight::angle) {
    // The largest angle is what the others leave of π.
    const F a = hn::Load(f, block.angles + i), b = hn::Load(f, block.angles + n_in_block + i);
    const F large = hn::Sub(hn::Set(f, std::numbers::pi_v<float>), hn::Add(a, b));
    const Largest largest = largest_of(load_terms(block, i));
    return {hn::IfThenElse(largest.is_0, large, a), hn::IfThenElse(largest.is_1, large, b),
            hn::IfThenElse(largest.is_0, a, hn::IfThenElse(largest.is_1, b, large))};
  } else if constexpr (weight == NormalWeight::max) {
    const F3 t = load_terms(block, i);
    return {hn::Div(length, hn::Mul(t.y, t.z)), hn::Div(length, hn::Mul(t.x, t.z)),
            hn::Div(length, hn::Mul(t.x, t.y))};
  } else {
    const F same = weight == NormalWeight::area ? length : hn::Set(f, 1.0f);
    return {same, same, same};
  }
}

/// Weighted normals in the place of the positions; NaN where float will not do.
template <NormalWeight weight>
HWY_INLINE void weigh(Block& block, std::size_t i) {
  const Floats f;
  const F3 n = {hn::Load(f, block.x + i), hn::Load(f, block.y + i), hn::Load(f, block.z + i)};
  const F length = hn::Load(f, block.length + i);
  const auto is_sure =
      hn::And(hn::Gt(length, hn::Set(f, least_length)), hn::Lt(length, hn::Set(f, greatest_length)));
  const F nan = hn::Set(f, std::numeric_limits<float>::quiet_NaN());
  const F3 normal = scale(n, hn::IfThenElse(is_sure, hn::Div(hn::Set(f, 1.0f), length), nan));
  const F3 w = weights_of<weight>(block, i, length);
  const auto store = [&](F share, int corner) HWY_ATTR {
    hn::StoreInterleaved4(hn::Mul(normal.x, share), hn::Mul(normal.y, share), hn::Mul(normal.z, share), share,
                          f, &block.corners[corner][4 * i]);
  };
  store(w.x, 0);
  store(w.y, 1);
  store(w.z, 2);
}

/// From positions to weighted normals, for up to a block of faces. In several loops: the machine works on
/// several faces at a time only where the chains of operations are short.
template <NormalWeight weight>
HWY_INLINE void compute(Block& block, std::size_t n, float per_unit) {
  const std::size_t lanes = hn::Lanes(Floats());
  for (std::size_t i = 0; i < n; i += lanes) measure<weight>(block, i, per_unit);
  for (std::size_t i = 0; i < n; i += lanes) find_lengths<weight>(block, i);
  if constexpr (weight == NormalWeight::angle)
    for (float* angles : {block.angles, block.angles + n_in_block})
      for (std::size_t i = 0; i < n; i += lanes) arctangents(angles + i);
  for (std::size_t i = 0; i < n; i += lanes) weigh<weight>(block, i);
}

/// The positions of up to a block of faces.
/// @tparam n_bytes  of a position; 16 moves faster, but reads the next one too.
template <std::size_t n_bytes>
HWY_INLINE void gather(const glm::vec3* positions, const glm::uvec3* triangles, std::size_t n,
                       Corners* corners) {
  for (std::size_t i = 0; i < n; ++i)
    for (int c = 0; c < 3; ++c) std::memcpy(&corners[c][4 * i], &positions[triangles[i][c]], n_bytes);
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
/// @param has_next   behind the positions of the faces' corners there are others.
template <NormalWeight weight, bool is_whole>
void add_all(const glm::vec3* positions, const glm::uvec3* triangles, std::size_t n,
             const NormalWindow& window, bool has_next) {
  Block block{};
  glm::uvec3 selected[n_in_block];
  // Copies: the sums might overwrite what `window` refers to, for all that the compiler knows.
  const std::uint32_t* const group_of = window.group_of.empty() ? nullptr : window.group_of.data();
  NormalSum* const sums = window.sums.data();
  const std::uint32_t first_group = window.first;
  const std::size_t n_sums = window.sums.size();
  const float per_unit = 1 / window.unit;
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
    if (has_next)
      gather<16>(positions, faces, n_here, block.corners);
    else
      gather<12>(positions, faces, n_here, block.corners);
    compute<weight>(block, n_here, per_unit);
    for (std::size_t i = 0; i < n_here; ++i) {
      const glm::uvec3& t = faces[i];
      if (std::isnan(block.corners[0][4 * i])) {
        add_face_exactly(positions, t, weight, nullptr, window);
        continue;
      }
      for (int c = 0; c < 3; ++c) {
        const std::uint32_t place = (group_of == nullptr ? t[c] : group_of[t[c]]) - first_group;
        if (!is_whole && place >= n_sums) continue;
        double* const sum = sums[place].normal;
        float added[4];
        std::memcpy(added, &block.corners[c][4 * i], sizeof added);
        for (int k = 0; k < 4; ++k) sum[k] += double(added[k]);
      }
    }
  }
}

template <NormalWeight weight>
void add_with(const glm::vec3* positions, const glm::uvec3* triangles, std::size_t n,
              const NormalWindow& window, bool is_whole, bool has_next) {
  if (is_whole)
    add_all<weight, true>(positions, triangles, n, window, has_next);
  else
    add_all<weight, false>(positions, triangles, n, window, has_next);
}

void add_faces_of(const glm::vec3* positions, const glm::uvec3* triangles, std::size_t n, NormalWeight weight,
                  const NormalWindow& window, bool is_whole, bool has_next) {
  switch (weight) {
    case NormalWeight::angle:
      return add_with<NormalWeight::angle>(positions, triangles, n, window, is_whole, has_next);
    case NormalWeight::area:
      return add_with<NormalWeight::area>(positions, triangles, n, window, is_whole, has_next);
    case NormalWeight::uniform:
      return add_with<NormalWeight::uniform>(positions, triangles, n, window, is_whole, has_next);
    case NormalWeight::max:
      return add_with<NormalWeight::max>(positions, triangles, n, window, is_whole, has_next);
  }
}

bool have_area_of(const glm::vec3* positions, const glm::uvec3* triangles, std::size_t n_triangles) {
  const Floats f;
  HWY_ALIGN Corners corners[3];
  for (std::size_t first = 0; first < n_triangles; first += n_in_block) {
    const std::size_t n_here = std::min(n_in_block, n_triangles - first);
    // Lanes past the last face take a sound one.
    for (std::size_t i = n_here; i < n_in_block; ++i) {
      for (Corners& corner : corners) std::fill_n(&corner[4 * i], 4, 0.0f);
      corners[1][4 * i] = corners[2][4 * i + 1] = 1;
    }
    gather<sizeof(glm::vec3)>(positions, triangles + first, n_here, corners);
    for (std::size_t i = 0; i < n_here; i += hn::Lanes(f)) {
      const F3 p0 = load_corners(f, &corners[0][4 * i]);
      const F3 e1 = subtract(load_corners(f, &corners[1][4 * i]), p0),
               e2 = subtract(load_corners(f, &corners[2][4 * i]), p0), n = cross(e1, e2);
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

IndexRange range_of(const std::uint32_t* indices, std::size_t n) {
  const hn::ScalableTag<std::uint32_t> u;
  auto least = hn::Set(u, indices[0]), greatest = least;
  std::size_t i = 0;
  for (; i + hn::Lanes(u) <= n; i += hn::Lanes(u)) {
    const auto here = hn::LoadU(u, indices + i);
    least = hn::Min(least, here);
    greatest = hn::Max(greatest, here);
  }
  IndexRange range{hn::GetLane(hn::MinOfLanes(u, least)), hn::GetLane(hn::MaxOfLanes(u, greatest))};
  for (; i < n; ++i) {
    range.first = std::min(range.first, indices[i]);
    range.last = std::max(range.last, indices[i]);
  }
  return range;
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
  const bool has_next = window.group_of.empty() && named.last + std::size_t{1} < positions.size();
  HWY_DYNAMIC_DISPATCH(add_faces_of)
  (positions.data(), triangles.data(), triangles.size(), weight, window, is_whole, has_next);
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
