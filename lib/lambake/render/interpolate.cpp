#include "lambake/render/interpolate.h"

#include <algorithm>

#include "lambake/render/visibility.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lambake/render/interpolate.cpp"
#include <hwy/foreach_target.h>  // compiles the part below once per vector path
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, PlaceBlock::group>;
using Ints = hn::Rebind<std::int32_t, Floats>;
using V = hn::Vec<Floats>;

/// One value in each lane.
struct V3 {
  V x, y, z;
};

/// Values at the corners of the triangles in the lanes.
struct CornerValues {
  V3 v[3];
};

/// Of one or two arrays at once.
template <std::size_t n>
using Arrays = std::array<const float*, n>;

template <std::size_t n>
HWY_INLINE void gather_corners(const Arrays<n>& values, const PlaceBlock& block, std::size_t i,
                               CornerValues (&corners)[n]) {
  const Floats f;
  const Ints i32;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto at = hn::Mul(hn::Load(i32, block.corners[c].data() + i), hn::Set(i32, 3));
    for (std::size_t a = 0; a < n; ++a)
      corners[a].v[c] = {hn::GatherIndex(f, values[a], at), hn::GatherIndex(f, values[a] + 1, at),
                         hn::GatherIndex(f, values[a] + 2, at)};
  }
}

/// The same where neighbours share triangles: each is loaded once and spread over its lanes.
template <std::size_t n>
HWY_INLINE void spread_corners(const Arrays<n>& values, const PlaceBlock& block, std::size_t i,
                               CornerValues (&corners)[n]) {
  const Floats f;
  const Ints i32;
  const V zero = hn::Zero(f);
  for (CornerValues& all : corners)
    for (V3& v : all.v) v = {zero, zero, zero};
  const auto triangle = hn::Load(i32, reinterpret_cast<const std::int32_t*>(block.triangles.data()) + i);
  for (std::size_t lane = 0; lane < hn::Lanes(f);) {
    const std::uint32_t t = block.triangles[i + lane];
    const auto mask = hn::RebindMask(f, hn::Eq(triangle, hn::Set(i32, static_cast<std::int32_t>(t))));
    for (int c = 0; c < 3; ++c) {
      const std::size_t at = 3 * std::size_t{block.mesh_triangles[t][c]};
      for (std::size_t a = 0; a < n; ++a) {
        const float* const value = values[a] + at;
        V3& v = corners[a].v[c];
        v.x = hn::IfThenElse(mask, hn::Set(f, value[0]), v.x);
        v.y = hn::IfThenElse(mask, hn::Set(f, value[1]), v.y);
        v.z = hn::IfThenElse(mask, hn::Set(f, value[2]), v.z);
      }
    }
    do ++lane;
    while (lane < hn::Lanes(f) && block.triangles[i + lane] == t);
  }
}

template <std::size_t n>
HWY_INLINE void load_corners(const Arrays<n>& values, const PlaceBlock& block, std::size_t i,
                             CornerValues (&corners)[n]) {
  if (block.has_few_triangles[i / PlaceBlock::group]) {
    spread_corners(values, block, i, corners);
  } else {
    gather_corners(values, block, i, corners);
  }
}

HWY_INLINE V mix(V v0, V v1, V v2, V b1, V b2) {
  return hn::Add(hn::Add(v0, hn::Mul(b1, hn::Sub(v1, v0))), hn::Mul(b2, hn::Sub(v2, v0)));
}

HWY_INLINE V3 mix(const CornerValues& at, const PlaceBlock& block, std::size_t i) {
  const Floats f;
  const V b1 = hn::Load(f, block.weights1.data() + i), b2 = hn::Load(f, block.weights2.data() + i);
  const V3 &v0 = at.v[0], &v1 = at.v[1], &v2 = at.v[2];
  return {mix(v0.x, v1.x, v2.x, b1, b2), mix(v0.y, v1.y, v2.y, b1, b2), mix(v0.z, v1.z, v2.z, b1, b2)};
}

/// Loads the 16 places at `triangles` and `barycentrics`.
void load_group(const Mesh& mesh, const std::uint32_t* triangles, const glm::vec2* barycentrics,
                std::size_t group, PlaceBlock& block) {
  const Floats f;
  const Ints i32;
  const std::int32_t* const corners = reinterpret_cast<const std::int32_t*>(mesh.triangles.data());
  std::int32_t* const block_triangles = reinterpret_cast<std::int32_t*>(block.triangles.data());
  std::uint32_t n_changes = 0, n_seen = triangles[0] != no_triangle;
  for (std::size_t lane = 1; lane < PlaceBlock::group; ++lane) {
    n_changes += triangles[lane] != triangles[lane - 1];
    n_seen += triangles[lane] != no_triangle;
  }
  const bool has_few_triangles = n_changes < PlaceBlock::group / 3;
  block.has_few_triangles[group] = has_few_triangles;
  block.is_covered[group] = n_seen == PlaceBlock::group;
  for (std::size_t lane = 0; lane < PlaceBlock::group; lane += hn::Lanes(f)) {
    const std::size_t i = group * PlaceBlock::group + lane;
    const auto seen = hn::LoadU(i32, reinterpret_cast<const std::int32_t*>(triangles) + lane);
    const auto triangle = hn::IfThenElseZero(hn::Gt(seen, hn::Set(i32, -1)), seen);  // no_triangle is −1
    hn::Store(triangle, i32, block_triangles + i);
    V b1, b2;
    hn::LoadInterleaved2(f, &barycentrics[lane].x, b1, b2);
    hn::Store(b1, f, block.weights1.data() + i);
    hn::Store(b2, f, block.weights2.data() + i);
    if (has_few_triangles) continue;
    const auto first = hn::Mul(triangle, hn::Set(i32, 3));
    for (std::size_t c = 0; c < 3; ++c)
      hn::Store(hn::GatherIndex(i32, corners + c, first), i32, block.corners[c].data() + i);
  }
}

void load_groups(const Mesh& mesh, std::span<const std::uint32_t> triangles,
                 std::span<const glm::vec2> barycentrics, PlaceBlock& block) {
  block.mesh_triangles = mesh.triangles.data();
  for (std::size_t g = 0; g < block.n_groups; ++g) {
    const std::size_t pixel = block.first_pixels[g];
    if (pixel + PlaceBlock::group <= triangles.size()) {
      load_group(mesh, &triangles[pixel], &barycentrics[pixel], g, block);
      continue;
    }
    std::array<std::uint32_t, PlaceBlock::group> last_triangles;
    std::array<glm::vec2, PlaceBlock::group> last_barycentrics{};
    last_triangles.fill(no_triangle);
    std::copy(triangles.begin() + static_cast<std::ptrdiff_t>(pixel), triangles.end(),
              last_triangles.begin());
    std::copy(barycentrics.begin() + static_cast<std::ptrdiff_t>(pixel), barycentrics.end(),
              last_barycentrics.begin());
    load_group(mesh, last_triangles.data(), last_barycentrics.data(), g, block);
  }
}

void interpolate_block(const float* values, const PlaceBlock& block, float* out) {
  const Floats f;
  for (std::size_t i = 0; i < block.n_places(); i += hn::Lanes(f)) {
    CornerValues corners[1];
    load_corners<1>({values}, block, i, corners);
    const V3 v = mix(corners[0], block, i);
    hn::StoreInterleaved3(v.x, v.y, v.z, f, out + 3 * i);
  }
}

HWY_INLINE auto are_equal(const V3& a, const V3& b) {
  return hn::And(hn::And(hn::Eq(a.x, b.x), hn::Eq(a.y, b.y)), hn::Eq(a.z, b.z));
}

HWY_INLINE V3 mix_normals(const CornerValues& corners, const PlaceBlock& block, std::size_t i) {
  const Floats f;
  const V zero = hn::Zero(f), one = hn::Set(f, 1.0f);
  const V3& n0 = corners.v[0];
  const V3 n = mix(corners, block, i);
  const V length = hn::Sqrt(hn::Add(hn::Add(hn::Mul(n.x, n.x), hn::Mul(n.y, n.y)), hn::Mul(n.z, n.z)));
  const V inverse = hn::IfThenElseZero(hn::Gt(length, zero), hn::Div(one, length));
  const auto is_flat = hn::And(are_equal(n0, corners.v[1]), are_equal(n0, corners.v[2]));
  return {hn::IfThenElse(is_flat, n0.x, hn::Mul(n.x, inverse)),
          hn::IfThenElse(is_flat, n0.y, hn::Mul(n.y, inverse)),
          hn::IfThenElse(is_flat, n0.z, hn::Mul(n.z, inverse))};
}

void normals_of_block(const float* normals, const PlaceBlock& block, float* out) {
  const Floats f;
  for (std::size_t i = 0; i < block.n_places(); i += hn::Lanes(f)) {
    CornerValues corners[1];
    load_corners<1>({normals}, block, i, corners);
    const V3 n = mix_normals(corners[0], block, i);
    hn::StoreInterleaved3(n.x, n.y, n.z, f, out + 3 * i);
  }
}

void points_of_block(const float* positions, const float* normals, const PlaceBlock& block,
                     float* out_positions, float* out_normals) {
  const Floats f;
  for (std::size_t i = 0; i < block.n_places(); i += hn::Lanes(f)) {
    CornerValues corners[2];
    load_corners<2>({positions, normals}, block, i, corners);
    const V3 p = mix(corners[0], block, i), n = mix_normals(corners[1], block, i);
    hn::StoreInterleaved3(p.x, p.y, p.z, f, out_positions + 3 * i);
    hn::StoreInterleaved3(n.x, n.y, n.z, f, out_normals + 3 * i);
  }
}

}  // namespace
}  // namespace lambake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lambake {

static_assert(sizeof(glm::vec3) == 3 * sizeof(float) && sizeof(LinearRgb) == 3 * sizeof(float));

namespace {
HWY_EXPORT(load_groups);
HWY_EXPORT(interpolate_block);
HWY_EXPORT(normals_of_block);
HWY_EXPORT(points_of_block);
}  // namespace

void load_places(const Mesh& mesh, std::span<const std::uint32_t> triangles,
                 std::span<const glm::vec2> barycentrics, PlaceBlock& block) {
  HWY_DYNAMIC_DISPATCH(load_groups)(mesh, triangles, barycentrics, block);
}

void interpolate(std::span<const LinearRgb> values, const PlaceBlock& block, std::span<LinearRgb> out) {
  HWY_DYNAMIC_DISPATCH(interpolate_block)(&values[0].r, block, &out[0].r);
}

void interpolate_normals(std::span<const glm::vec3> normals, const PlaceBlock& block,
                         std::span<glm::vec3> out) {
  HWY_DYNAMIC_DISPATCH(normals_of_block)(&normals[0].x, block, &out[0].x);
}

void interpolate_points(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                        const PlaceBlock& block, std::span<glm::vec3> out_positions,
                        std::span<glm::vec3> out_normals) {
  HWY_DYNAMIC_DISPATCH(points_of_block)
  (&positions[0].x, &normals[0].x, block, &out_positions[0].x, &out_normals[0].x);
}

}  // namespace lambake
#endif  // HWY_ONCE
