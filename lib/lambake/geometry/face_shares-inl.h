/// What faces add to the normals of their corners, for as many faces at a time as a vector has lanes.
/// Included by each vector path: the guard lets it in once for each.
#if defined(LAMBAKE_GEOMETRY_FACE_SHARES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LAMBAKE_GEOMETRY_FACE_SHARES_INL_H
#undef LAMBAKE_GEOMETRY_FACE_SHARES_INL_H
#else
#define LAMBAKE_GEOMETRY_FACE_SHARES_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <numbers>

#include "lambake/geometry/normal_sums.h"
#include "lambake/geometry/transpose-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

/// Faces at a time: what is between the loops over them stays in the level 1 cache.
constexpr std::size_t n_in_block = 64;

/// Four numbers for each face of a block.
using Rows = float[4 * n_in_block];

/// Faces on their way from positions to what they add to the sums of their corners.
struct alignas(64) Block {
  Rows normals;  // Unit normal and 1; times the weight if that is the same at all corners. NaN: see weigh().
  Rows weights;  // Of the three corners, if they differ; the last is 0.
  float x[n_in_block], y[n_in_block], z[n_in_block];  // Twice the area vector; NaN where there may be none.
  float terms[3][n_in_block];                         // Of each corner's weight. All in units of the window.
  float is_sliver[n_in_block];                        // 0 or 1.
  float length[n_in_block];                           // Of the area vector; before find_lengths() squared.
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

/// A face adds the same at all its corners.
constexpr bool has_one_share(NormalWeight weight) {
  return weight == NormalWeight::area || weight == NormalWeight::uniform;
}

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
HWY_INLINE F position_of(const glm::vec3* positions, std::uint32_t v) {
  return hn::LoadDup128(Floats(), &positions[v].x);
}

/// x, y, z of one vertex, and what comes after, in each quarter of a vector: of the same corner of one face
/// and of those behind it.
HWY_INLINE F row_of(const glm::vec3* positions, const std::uint32_t* v) {
#if HWY_MAX_BYTES >= 64
  if constexpr (hn::MaxLanes(Floats()) == 16) {
    const hn::Half<Floats> half;
    const auto two = [&](const std::uint32_t* u) HWY_ATTR {
      const hn::Half<decltype(half)> quarter;
      return hn::Combine(half, hn::LoadU(quarter, &positions[u[3]].x),
                         hn::LoadU(quarter, &positions[u[0]].x));
    };
    return hn::Combine(Floats(), two(v + 6), two(v));
  }
#endif
#if HWY_MAX_BYTES >= 32
  if constexpr (hn::MaxLanes(Floats()) == 8)
    return hn::ConcatUpperLower(Floats(), position_of(positions, v[3]), position_of(positions, v[0]));
#endif
  return position_of(positions, v[0]);
}

/// The positions of one corner of as many faces as a vector has lanes, in the order of transposed(). Reads 16
/// bytes of each.
/// @param v  the corner of the first face; that of the next is three numbers on.
HWY_INLINE F3 load_corners(const glm::vec3* positions, const std::uint32_t* v) {
#if HWY_TARGET == HWY_SCALAR
  const Floats f;
  const glm::vec3& p = positions[*v];
  return {hn::Set(f, p.x), hn::Set(f, p.y), hn::Set(f, p.z)};
#else
  constexpr std::size_t step = 3 * (hn::MaxLanes(Floats()) / 4);  // A row is of one, two or four faces.
  const FourVectors corners = transposed({row_of(positions, v), row_of(positions, v + step),
                                          row_of(positions, v + 2 * step), row_of(positions, v + 3 * step)});
  return {corners.a, corners.b, corners.c};
#endif
}

/// Four numbers of each face, in the order of the faces.
HWY_INLINE void store_rows(const F3& v, F last, float* rows) {
#if HWY_TARGET == HWY_SCALAR
  rows[0] = hn::GetLane(v.x), rows[1] = hn::GetLane(v.y), rows[2] = hn::GetLane(v.z),
  rows[3] = hn::GetLane(last);
#else
  const Floats f;
  const FourVectors row = transposed({v.x, v.y, v.z, last});
  const std::size_t n = hn::Lanes(f);
  hn::Store(row.a, f, rows);
  hn::Store(row.b, f, rows + n);
  hn::Store(row.c, f, rows + 2 * n);
  hn::Store(row.d, f, rows + 3 * n);
#endif
}

template <NormalWeight weight, typename Tag>
HWY_INLINE void store_measured(Tag tag, const Vector3<hn::Vec<Tag>>& n, const Vector3<hn::Vec<Tag>>& terms,
                               Block& block, std::size_t i) {
  hn::Store(n.x, tag, block.x + i);
  hn::Store(n.y, tag, block.y + i);
  hn::Store(n.z, tag, block.z + i);
  hn::Store(dot(n, n), tag, block.length + i);
  if constexpr (weight == NormalWeight::angle || weight == NormalWeight::max) {
    hn::Store(terms.x, tag, block.terms[0] + i);
    hn::Store(terms.y, tag, block.terms[1] + i);
    hn::Store(terms.z, tag, block.terms[2] + i);
  }
}

/// The positions of the corners of as many faces as a vector has lanes: by corner, x, y or z, and face.
struct alignas(64) CornerPositions {
  float values[3][3][hn::MaxLanes(Floats())];
};

/// measure() for slivers, in double. @param k  first of the faces in `corners`, which is i + k in the block.
template <NormalWeight weight>
HWY_INLINE void measure_slivers(const CornerPositions& corners, std::size_t k, Block& block, std::size_t i,
                                float per_unit) {
  const Doubles d;
  const FewFloats f;
  const auto is_sliver = hn::Gt(hn::Load(f, block.is_sliver + i + k), hn::Zero(f));
  if (hn::AllFalse(f, is_sliver)) return;
  const auto corner = [&](int c) HWY_ATTR {
    const auto& values = corners.values[c];
    return promote({hn::Load(f, values[0] + k), hn::Load(f, values[1] + k), hn::Load(f, values[2] + k)});
  };
  const D3 p0 = corner(0), p1 = corner(1), p2 = corner(2);
  i += k;
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
HWY_INLINE void measure(const glm::vec3* positions, const glm::uvec3* faces, Block& block, std::size_t i,
                        float per_unit) {
  const Floats f;
  const F3 p0 = load_corners(positions, &faces[i].x), p1 = load_corners(positions, &faces[i].y),
           p2 = load_corners(positions, &faces[i].z);
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
  CornerPositions corners;
  const F3 stored[] = {p0, p1, p2};
  for (int c = 0; c < 3; ++c) {
    hn::Store(stored[c].x, f, corners.values[c][0]);
    hn::Store(stored[c].y, f, corners.values[c][1]);
    hn::Store(stored[c].z, f, corners.values[c][2]);
  }
  for (std::size_t k = 0; k < hn::Lanes(f); k += hn::Lanes(Doubles()))
    measure_slivers<weight>(corners, k, block, i, per_unit);
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
  const F length = hn::Sqrt(hn::Load(f, block.length + i));
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

/// Fills in the normals and weights. @returns false if there are faces for which float will not do: their
/// normals are NaN.
template <NormalWeight weight>
HWY_INLINE bool weigh(Block& block, std::size_t i) {
  const Floats f;
  const F3 n = {hn::Load(f, block.x + i), hn::Load(f, block.y + i), hn::Load(f, block.z + i)};
  const F length = hn::Load(f, block.length + i), one = hn::Set(f, 1.0f);
  const F3 w = weights_of<weight>(block, i, length);
  auto is_sure =
      hn::And(hn::Gt(length, hn::Set(f, least_length)), hn::Lt(length, hn::Set(f, greatest_length)));
  // Products of the squares of long sides overflow, and leave no weight.
  if constexpr (weight == NormalWeight::max)
    is_sure = hn::And(is_sure, hn::Gt(hn::Min(w.x, hn::Min(w.y, w.z)), hn::Zero(f)));
  const F nan = hn::Set(f, std::numeric_limits<float>::quiet_NaN());
  const F3 normal = scale(n, hn::IfThenElse(is_sure, hn::Div(one, length), nan));
  if constexpr (has_one_share(weight)) {
    store_rows(scale(normal, w.x), w.x, block.normals + 4 * i);
  } else {
    store_rows(normal, one, block.normals + 4 * i);
    store_rows(w, hn::Zero(f), block.weights + 4 * i);
  }
  return hn::AllTrue(f, is_sure);
}

/// From positions to normals and weights, for up to a block of faces. In several loops: the machine works on
/// several faces at a time only where the chains of operations are short.
/// @returns false if there are faces for which float will not do: their normals are NaN.
template <NormalWeight weight>
HWY_INLINE bool compute(const glm::vec3* positions, const glm::uvec3* faces, std::size_t n, float per_unit,
                        Block& block) {
  const std::size_t lanes = hn::Lanes(Floats());
  for (std::size_t i = 0; i < n; i += lanes) measure<weight>(positions, faces, block, i, per_unit);
  for (std::size_t i = 0; i < n; i += lanes) find_lengths<weight>(block, i);
  if constexpr (weight == NormalWeight::angle)
    for (float* angles : {block.angles, block.angles + n_in_block})
      for (std::size_t i = 0; i < n; i += lanes) arctangents(angles + i);
  bool are_sure = true;
  for (std::size_t i = 0; i < n; i += lanes) are_sure &= weigh<weight>(block, i);
  return are_sure;
}

/// Four numbers in double: those of a sum.
#if HWY_MAX_BYTES >= 32
using Four = hn::FixedTag<double, 4>;
using Row = hn::Vec<Four>;

HWY_INLINE Row load_row(const float* row) {
  return hn::PromoteTo(Four(), hn::Load(hn::FixedTag<float, 4>(), row));
}
template <int corner>
HWY_INLINE Row times_weight(Row row, Row weights) {
  const Row pair = corner < 2 ? hn::ConcatLowerLower(Four(), weights, weights)
                              : hn::ConcatUpperUpper(Four(), weights, weights);
  return hn::Mul(
      row, corner == 1 ? hn::InterleaveUpper(Four(), pair, pair) : hn::InterleaveLower(Four(), pair, pair));
}
HWY_INLINE void add_row(Row row, NormalSum& sum) {
  hn::Store(hn::Add(hn::Load(Four(), sum.values), row), Four(), sum.values);
}
#else
struct Row {
  double values[4];
};

HWY_INLINE Row load_row(const float* row) {
  return {{row[0], row[1], row[2], row[3]}};
}
template <int corner>
HWY_INLINE Row times_weight(Row row, const Row& weights) {
  for (double& value : row.values) value *= weights.values[corner];
  return row;
}
HWY_INLINE void add_row(const Row& row, NormalSum& sum) {
  for (int k = 0; k < 4; ++k) sum.values[k] += row.values[k];
}
#endif

/// Up to a block of faces with copies of their corners' positions, 16 bytes of each of which may be read.
/// Filled up with the last face.
struct CopiedFaces {
  glm::vec3 positions[3 * n_in_block + 1] = {};
  glm::uvec3 faces[n_in_block];

  CopiedFaces() {
    for (std::uint32_t i = 0; i < n_in_block; ++i) faces[i] = {3 * i, 3 * i + 1, 3 * i + 2};
  }

  void copy(const glm::vec3* from, const glm::uvec3* triangles, std::size_t n) {
    for (std::size_t i = 0; i < n_in_block; ++i) {
      const glm::uvec3& t = triangles[std::min(i, n - 1)];
      positions[3 * i] = from[t.x], positions[3 * i + 1] = from[t.y], positions[3 * i + 2] = from[t.z];
    }
  }
};

}  // namespace
}  // namespace lambake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
