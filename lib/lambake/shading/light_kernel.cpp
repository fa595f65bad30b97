#include "lambake/shading/light_kernel.h"

#include <array>
#include <cmath>
#include <limits>

#include "lambake/core/error.h"
#include "lambake/shading/lambert.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lambake/shading/light_kernel.cpp"
#include <hwy/foreach_target.h>  // compiles the part below once per vector path
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using V = hn::Vec<Floats>;
using M = hn::Mask<Floats>;

/// One point in each lane.
struct V3 {
  V x, y, z;
};

V3 load(const glm::vec3* points) {
  V3 v;
  hn::LoadInterleaved3(Floats(), &points->x, v.x, v.y, v.z);
  return v;
}

V3 broadcast(const glm::vec3& v) {
  const Floats d;
  return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}

/// In glm's order, so that the sum rounds as in the scalar form.
HWY_INLINE V dot(const V3& a, const V3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

HWY_INLINE V3 subtract(const V3& a, const V3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

HWY_INLINE V clamp01(V v) {
  const Floats d;
  return hn::Min(hn::Max(v, hn::Zero(d)), hn::Set(d, 1.0f));
}

HWY_INLINE void add_light(V3& sum, const LinearRgb& intensity, V received) {
  const Floats d;
  sum.x = hn::Add(sum.x, hn::Mul(hn::Set(d, intensity.r), received));
  sum.y = hn::Add(sum.y, hn::Mul(hn::Set(d, intensity.g), received));
  sum.z = hn::Add(sum.z, hn::Mul(hn::Set(d, intensity.b), received));
}

/// Lanes in which the light is in front and gives a direction; the conditions of received().
HWY_INLINE M is_lit(V facing, V distance_squared) {
  const Floats d;
  return hn::And(hn::And(hn::Gt(facing, hn::Zero(d)), hn::Gt(distance_squared, hn::Zero(d))),
                 hn::Lt(distance_squared, hn::Set(d, std::numeric_limits<float>::infinity())));
}

/// falloff() of lambert.h.
V falloff_of(const Light& light, V distance_squared) {
  const Floats d;
  const V one = hn::Set(d, 1.0f);
  V f = one;
  if (light.decay == 2.0f) {
    f = hn::Div(one, distance_squared);
  } else if (light.decay == 1.0f) {
    f = hn::Div(one, hn::Sqrt(distance_squared));
  } else if (light.decay == 4.0f) {
    f = hn::Div(one, distance_squared);
    f = hn::Mul(f, f);
  } else if (light.decay != 0.0f) {
    // No exponent of practice comes here: the scalar pow keeps its last bit.
    HWY_ALIGN std::array<float, hn::MaxLanes(Floats())> lanes;
    hn::Store(distance_squared, d, lanes.data());
    for (float& lane : lanes) lane = std::pow(lane, -0.5f * light.decay);
    f = hn::Load(d, lanes.data());
  }
  if (light.range > 0) {
    const V ratio = hn::Div(distance_squared, hn::Set(d, light.range * light.range));
    f = hn::Mul(f, clamp01(hn::Sub(one, hn::Mul(ratio, ratio))));
  }
  return f;
}

/// spot_cone() of lambert.h.
V spot_cone_of(const Light& light, const V3& to_light) {
  const Floats d;
  const float outer = versine(light.outer_cone_rad);
  const float scale = 1.0f / std::max(0.001f, outer - versine(light.inner_cone_rad));
  const V3 axis = broadcast(light.spot_direction);
  const V3 off{hn::Add(axis.x, to_light.x), hn::Add(axis.y, to_light.y), hn::Add(axis.z, to_light.z)};
  const V half = hn::Mul(dot(off, off), hn::Set(d, 0.5f));
  const V ramp = clamp01(hn::Mul(hn::Sub(hn::Set(d, outer), half), hn::Set(d, scale)));
  return hn::Mul(ramp, ramp);
}

using Source = PackedLights::Source;

HWY_INLINE void add_directional(std::span<const Source> sources, const V3& normal, V3& sum) {
  const V zero = hn::Zero(Floats());
  for (const Source& source : sources) {
    const V cosine = dot(normal, broadcast(source.place));
    add_light(sum, source.intensity, hn::IfThenElseZero(hn::Gt(cosine, zero), cosine));
  }
}

HWY_INLINE void add_inverse_square(std::span<const Source> sources, const V3& position, const V3& normal,
                                   V3& sum) {
  const Floats d;
  for (const Source& source : sources) {
    const V3 to_light = subtract(broadcast(source.place), position);
    const V distance_squared = dot(to_light, to_light);
    const V facing = dot(normal, to_light);
    const M lit = is_lit(facing, distance_squared);
    if (hn::AllFalse(d, lit)) continue;  // neighbours face the same way: saves the root and the divisions
    const V received =
        hn::Mul(hn::Div(facing, hn::Sqrt(distance_squared)), hn::Div(hn::Set(d, 1.0f), distance_squared));
    add_light(sum, source.intensity, hn::IfThenElseZero(lit, received));
  }
}

void add_general(std::span<const Light> lights, const V3& position, const V3& normal, V3& sum) {
  const Floats d;
  for (const Light& light : lights) {
    const V3 to_light = subtract(broadcast(light.position), position);
    const V distance_squared = dot(to_light, to_light);
    const V facing = dot(normal, to_light);
    const M lit = is_lit(facing, distance_squared);
    if (hn::AllFalse(d, lit)) continue;
    const V distance = hn::Sqrt(distance_squared);
    V received = hn::Mul(hn::Div(facing, distance), falloff_of(light, distance_squared));
    if (light.type == LightType::spot)
      received =
          hn::Mul(received, spot_cone_of(light, {hn::Div(to_light.x, distance), hn::Div(to_light.y, distance),
                                                 hn::Div(to_light.z, distance)}));
    add_light(sum, light.intensity, hn::IfThenElseZero(lit, received));
  }
}

/// A light in every lane.
struct DirectionalLanes {
  V3 direction, intensity;
};

/// E at as many points as a vector has lanes, of one sun: apart from the runs, as there the loads and stores
/// are what counts.
HWY_INLINE void irradiance_of_vector(const DirectionalLanes& sun, const glm::vec3* /*positions*/,
                                     const glm::vec3* normals, LinearRgb* out) {
  const Floats d;
  const V cosine = dot(load(normals), sun.direction);
  const V received = hn::IfThenElseZero(hn::Gt(cosine, hn::Zero(d)), cosine);
  hn::StoreInterleaved3(hn::Mul(sun.intensity.x, received), hn::Mul(sun.intensity.y, received),
                        hn::Mul(sun.intensity.z, received), d, &out->r);
}

/// The same of any lights. `positions` is null if none needs them.
HWY_INLINE void irradiance_of_vector(const PackedLights& lights, const glm::vec3* positions,
                                     const glm::vec3* normals, LinearRgb* out) {
  const Floats d;
  const V zero = hn::Zero(d);
  const V3 normal = load(normals);
  V3 position{zero, zero, zero}, sum = position;
  if (positions != nullptr) position = load(positions);
  const std::span<const Source> sources = lights.sources;
  for (const PackedLights::Run& run : lights.runs) {
    switch (run.kind) {
      case PackedLights::Kind::directional:
        add_directional(sources.subspan(run.begin, run.end - run.begin), normal, sum);
        break;
      case PackedLights::Kind::inverse_square:
        add_inverse_square(sources.subspan(run.begin, run.end - run.begin), position, normal, sum);
        break;
      case PackedLights::Kind::general:
        add_general(std::span(lights.general).subspan(run.general_begin, run.end - run.begin), position,
                    normal, sum);
        break;
    }
  }
  hn::StoreInterleaved3(sum.x, sum.y, sum.z, d, &out->r);
}

template <typename Lights>
void irradiance_of_points(const Lights& lights, const glm::vec3* positions, const glm::vec3* normals,
                          LinearRgb* out, std::size_t n) {
  const std::size_t lanes = hn::Lanes(Floats());
  std::size_t i = 0;
  for (; i + lanes <= n; i += lanes)
    irradiance_of_vector(lights, positions == nullptr ? nullptr : positions + i, normals + i, out + i);
  if (i == n) return;
  // The rest as one vector whose other lanes have no normal, hence no light.
  constexpr std::size_t max_lanes = hn::MaxLanes(Floats());
  std::array<glm::vec3, max_lanes> last_positions{}, last_normals{};
  std::array<LinearRgb, max_lanes> last_out{};
  std::copy(normals + i, normals + n, last_normals.begin());
  if (positions != nullptr) std::copy(positions + i, positions + n, last_positions.begin());
  irradiance_of_vector(lights, positions == nullptr ? nullptr : last_positions.data(), last_normals.data(),
                       last_out.data());
  std::copy_n(last_out.begin(), n - i, out + i);
}

void irradiance_of_lights(const PackedLights& lights, const glm::vec3* positions, const glm::vec3* normals,
                          LinearRgb* out, std::size_t n) {
  if (lights.sources.size() != 1 || lights.runs[0].kind != PackedLights::Kind::directional)
    return irradiance_of_points(lights, positions, normals, out, n);
  const auto& [place, intensity] = lights.sources[0];
  const DirectionalLanes sun{broadcast(place), broadcast({intensity.r, intensity.g, intensity.b})};
  irradiance_of_points(sun, positions, normals, out, n);
}

}  // namespace
}  // namespace lambake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lambake {

static_assert(sizeof(glm::vec3) == 3 * sizeof(float) && sizeof(LinearRgb) == 3 * sizeof(float));

namespace {
HWY_EXPORT(irradiance_of_lights);
}  // namespace

PackedLights pack_lights(std::span<const Light> lights) {
  PackedLights packed;
  packed.sources.reserve(lights.size());
  using Kind = PackedLights::Kind;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const Light& light = lights[i];
    const bool is_directional = light.type == LightType::directional;
    const bool is_inverse_square = light.type == LightType::point && light.decay == 2 && !(light.range > 0);
    const Kind kind = is_directional      ? Kind::directional
                      : is_inverse_square ? Kind::inverse_square
                                          : Kind::general;
    if (packed.runs.empty() || packed.runs.back().kind != kind)
      packed.runs.push_back({kind, i, i, packed.general.size()});
    packed.runs.back().end = i + 1;
    packed.sources.push_back({is_directional ? light.direction_to_light : light.position, light.intensity});
    if (kind == Kind::general) packed.general.push_back(light);
    packed.needs_positions |= !is_directional;
  }
  return packed;
}

void irradiance(const PackedLights& lights, std::span<const glm::vec3> positions,
                std::span<const glm::vec3> normals, std::span<LinearRgb> out) {
  if (normals.size() != out.size() || (lights.needs_positions && positions.size() != out.size()))
    throw InvalidOption("irradiance: expected as many positions and normals as results");
  HWY_DYNAMIC_DISPATCH(irradiance_of_lights)
  (lights, lights.needs_positions ? positions.data() : nullptr, normals.data(), out.data(), out.size());
}

}  // namespace lambake
#endif  // HWY_ONCE
