#include "lambake/render/interpolate.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lambake/render/interpolate.cpp"
#include <hwy/foreach_target.h>  // compiles the part below once per vector path
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

// At most 16 lanes, so that a block is a whole number of vectors.
using Floats = hn::CappedTag<float, 16>;
using Ints = hn::Rebind<std::int32_t, Floats>;
using V = hn::Vec<Floats>;

/// One value in each lane.
struct V3 {
  V x, y, z;
};

HWY_INLINE V3 gather(const float* values, const std::int32_t* vertices) {
  const Floats f;
  const Ints i32;
  const auto at = hn::Mul(hn::Load(i32, vertices), hn::Set(i32, 3));
  return {hn::GatherIndex(f, values, at), hn::GatherIndex(f, values + 1, at),
          hn::GatherIndex(f, values + 2, at)};
}

HWY_INLINE V mix(V v0, V v1, V v2, V b1, V b2) {
  return hn::Add(hn::Add(v0, hn::Mul(b1, hn::Sub(v1, v0))), hn::Mul(b2, hn::Sub(v2, v0)));
}

HWY_INLINE V3 mix(const V3& v0, const V3& v1, const V3& v2, V b1, V b2) {
  return {mix(v0.x, v1.x, v2.x, b1, b2), mix(v0.y, v1.y, v2.y, b1, b2), mix(v0.z, v1.z, v2.z, b1, b2)};
}

void corners_of_block(const Mesh& mesh, PlaceBlock& block) {
  const Ints i32;
  const std::int32_t* const corners = reinterpret_cast<const std::int32_t*>(mesh.triangles.data());
  const std::int32_t* const triangles = reinterpret_cast<const std::int32_t*>(block.triangles.data());
  for (std::size_t i = 0; i < block.n; i += hn::Lanes(i32)) {
    const auto first = hn::Mul(hn::Load(i32, triangles + i), hn::Set(i32, 3));
    for (std::size_t c = 0; c < 3; ++c)
      hn::Store(hn::GatherIndex(i32, corners + c, first), i32, block.corners[c].data() + i);
  }
}

void interpolate_block(const float* values, const PlaceBlock& block, float* out) {
  const Floats f;
  for (std::size_t i = 0; i < block.n; i += hn::Lanes(f)) {
    const V3 v0 = gather(values, block.corners[0].data() + i),
             v1 = gather(values, block.corners[1].data() + i),
             v2 = gather(values, block.corners[2].data() + i);
    const V3 v =
        mix(v0, v1, v2, hn::Load(f, block.weights1.data() + i), hn::Load(f, block.weights2.data() + i));
    hn::StoreInterleaved3(v.x, v.y, v.z, f, out + 3 * i);
  }
}

HWY_INLINE auto are_equal(const V3& a, const V3& b) {
  return hn::And(hn::And(hn::Eq(a.x, b.x), hn::Eq(a.y, b.y)), hn::Eq(a.z, b.z));
}

void normals_of_block(const float* normals, const PlaceBlock& block, float* out) {
  const Floats f;
  const V zero = hn::Zero(f), one = hn::Set(f, 1.0f);
  for (std::size_t i = 0; i < block.n; i += hn::Lanes(f)) {
    const V3 n0 = gather(normals, block.corners[0].data() + i),
             n1 = gather(normals, block.corners[1].data() + i),
             n2 = gather(normals, block.corners[2].data() + i);
    const V3 n =
        mix(n0, n1, n2, hn::Load(f, block.weights1.data() + i), hn::Load(f, block.weights2.data() + i));
    const V length = hn::Sqrt(hn::Add(hn::Add(hn::Mul(n.x, n.x), hn::Mul(n.y, n.y)), hn::Mul(n.z, n.z)));
    const V inverse = hn::IfThenElseZero(hn::Gt(length, zero), hn::Div(one, length));
    const auto is_flat = hn::And(are_equal(n0, n1), are_equal(n0, n2));
    hn::StoreInterleaved3(hn::IfThenElse(is_flat, n0.x, hn::Mul(n.x, inverse)),
                          hn::IfThenElse(is_flat, n0.y, hn::Mul(n.y, inverse)),
                          hn::IfThenElse(is_flat, n0.z, hn::Mul(n.z, inverse)), f, out + 3 * i);
  }
}

}  // namespace
}  // namespace lambake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lambake {

static_assert(sizeof(glm::vec3) == 3 * sizeof(float) && sizeof(LinearRgb) == 3 * sizeof(float));

namespace {
HWY_EXPORT(corners_of_block);
HWY_EXPORT(interpolate_block);
HWY_EXPORT(normals_of_block);
}  // namespace

void find_corners(const Mesh& mesh, PlaceBlock& block) {
  HWY_DYNAMIC_DISPATCH(corners_of_block)(mesh, block);
}

void interpolate(std::span<const glm::vec3> values, const PlaceBlock& block, std::span<glm::vec3> out) {
  HWY_DYNAMIC_DISPATCH(interpolate_block)(&values[0].x, block, &out[0].x);
}

void interpolate(std::span<const LinearRgb> values, const PlaceBlock& block, std::span<LinearRgb> out) {
  HWY_DYNAMIC_DISPATCH(interpolate_block)(&values[0].r, block, &out[0].r);
}

void interpolate_normals(std::span<const glm::vec3> normals, const PlaceBlock& block,
                         std::span<glm::vec3> out) {
  HWY_DYNAMIC_DISPATCH(normals_of_block)(&normals[0].x, block, &out[0].x);
}

}  // namespace lambake
#endif  // HWY_ONCE
