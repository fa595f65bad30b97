/// What lights give over a patch, enclosed: four of one kind at a time. Included by each vector path: the
/// guard lets it in once for each.
#if defined(LAMBAKE_SHADING_ENCLOSED_LIGHT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LAMBAKE_SHADING_ENCLOSED_LIGHT_INL_H
#undef LAMBAKE_SHADING_ENCLOSED_LIGHT_INL_H
#else
#define LAMBAKE_SHADING_ENCLOSED_LIGHT_INL_H
#endif

#include <array>
#include <glm/glm.hpp>
#include <limits>

#include "lambake/shading/enclosure-inl.h"
#include "lambake/shading/light_blocks.h"
#include "lambake/shading/patch.h"

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {
namespace {

template <typename T>
struct VectorOf {
  T x, y, z;
};

/// A vector that is linear over a patch, by its corners.
template <typename T>
using Corners = std::array<VectorOf<T>, 3>;

template <typename T>
HWY_INLINE VectorOf<T> operator-(const VectorOf<T>& a, const VectorOf<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

template <typename T>
HWY_INLINE T dot(const VectorOf<T>& a, const VectorOf<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <typename T>
HWY_INLINE Corners<T> corners_of(const glm::dmat3& m) {
  return {{{T(m[0].x), T(m[0].y), T(m[0].z)},
           {T(m[1].x), T(m[1].y), T(m[1].z)},
           {T(m[2].x), T(m[2].y), T(m[2].z)}}};
}

/// u·v: exact in this form.
template <typename T>
HWY_INLINE EnclosureOf<T> dot(const Corners<T>& u, const Corners<T>& v) {
  EnclosureOf<T> e;
  T square_u(0.0), square_v(0.0);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    e.linear[k] = dot(u[k], v[k]);
    e.quadratic[k] = -dot(u[next] - u[k], v[next] - v[k]);
    square_u = most(square_u, dot(u[k], u[k])), square_v = most(square_v, dot(v[k], v[k]));
  }
  widen(e, T(8.0) * root(square_u) * root(square_v));
  return e;
}

/// A square this much smaller than its largest corner is not told from 0: parts get smaller until it is.
constexpr double vanishing = 1e-5;

/// @param values  range(square).
template <typename T>
HWY_INLINE auto is_positive(const EnclosureOf<T>& square, const IntervalOf<T>& values) {
  return T(vanishing) * most(square.linear[0], square.linear[1], square.linear[2]) < values.low;
}

/// Of lights side by side what the equation needs of a light.
struct LightLanes {
  VectorOf<Lanes> at;  ///< The position, or the direction to the light.
  Lanes range;
  VectorOf<Lanes> axis;  ///< Of a cone.
  Lanes cos_outer, cone_scale;
};

HWY_INLINE Lanes load(const double* values) {
  return hn::Load(LaneTag(), values);
}

/// @param first  of the lights of the block.
HWY_INLINE LightLanes load_lights(const LightBlock& block, std::size_t first) {
  return {{load(block.x + first), load(block.y + first), load(block.z + first)},
          load(block.range + first),
          {load(block.axis_x + first), load(block.axis_y + first), load(block.axis_z + first)},
          load(block.cos_outer + first),
          load(block.cone_scale + first)};
}

/// Falloff window, as falloff() of lambert.h has it.
inline EnclosureOf<Lanes> window_over(const LightLanes& light, const EnclosureOf<Lanes>& distance_squared) {
  const Lanes one(1.0);
  const EnclosureOf<Lanes> ratio = scaled(one / (light.range * light.range), distance_squared);
  return positive_part(linear(one, one, one) + negative(ratio * ratio));
}

/// Cone, as spot_cone() of lambert.h has it; outer − |axis + ω|²/2 in terms of axis·ω.
inline EnclosureOf<Lanes> cone_over(const LightLanes& light, const Corners<Lanes>& to_light,
                                    const EnclosureOf<Lanes>& inverse_distance) {
  const Lanes one(1.0);
  const VectorOf<Lanes> back{-light.axis.x, -light.axis.y, -light.axis.z};
  const EnclosureOf<Lanes> along = dot(to_light, Corners<Lanes>{{back, back, back}}) * inverse_distance;
  const EnclosureOf<Lanes> x =
      scaled(light.cone_scale, along + linear(-light.cos_outer, -light.cos_outer, -light.cos_outer));
  const EnclosureOf<Lanes> ramp = positive_part(x) + negative(positive_part(x + linear(-one, -one, -one)));
  return ramp * ramp;
}

/// Encloses max(0, N·ω)·f(d) of lights of one kind over a patch: ‖N‖ times what it receives, or with
/// `has_normal` false just what it receives. Infinite where it has no bound.
/// @param n        normals of the patch. @param p  its positions.
/// @param longest  at least the longest normal of the patch; 1 with `has_normal` false.
HWY_INLINE EnclosureOf<Lanes> received_over(const LightKind& kind, const LightLanes& light,
                                            const Corners<Lanes>& n, const Corners<Lanes>& p, bool has_normal,
                                            double longest) {
  const Lanes zero(0.0), infinity(std::numeric_limits<double>::infinity());
  if (kind.type == LightType::directional) {
    const EnclosureOf<Lanes> s = dot(n, Corners<Lanes>{{light.at, light.at, light.at}});
    const auto is_dark = range(s).high <= zero;
    // n·ω is at most |ω|, which is 1 up to the rounding of its three floats.
    return select(is_dark, EnclosureOf<Lanes>{},
                  has_normal ? positive_part(s) : anything_in<Lanes>({zero, Lanes(1 + 1e-6)}));
  }
  const Corners<Lanes> to_light{{light.at - p[0], light.at - p[1], light.at - p[2]}};
  const EnclosureOf<Lanes> s = dot(n, to_light), distance_squared = dot(to_light, to_light);
  const IntervalOf<Lanes> distances = range(distance_squared);
  auto is_dark = range(s).high <= zero;
  if (kind.has_range) is_dark = is_dark | (light.range * light.range <= distances.low);
  if (all(is_dark)) return {};

  const double k = kind.decay;
  const Lanes room(longest * (1 + 1e-12));
  const Lanes at_most =
      k == 0 ? room
             : select(zero < distances.low,
                      room * (k == 2 ? Lanes(1.0) / distances.low : power_of(distances.low, -0.5 * k)),
                      infinity);
  EnclosureOf<Lanes> value;
  if (has_normal) {
    value = positive_part(s) * power(distance_squared, -0.5 * (k + 1));
  } else {
    value = anything_in<Lanes>({zero, Lanes(1.0)});
    if (k > 0) value = value * power(distance_squared, -0.5 * k);
  }
  if (kind.has_range) value = value * window_over(light, distance_squared);
  if (kind.type == LightType::spot) value = value * cone_over(light, to_light, power(distance_squared, -0.5));
  // Not a number where a power has left double, or d² is not told from 0: nothing is known then but the most.
  const IntervalOf<Lanes> values = range(value);
  const auto is_known = is_positive(distance_squared, distances) & (values.high - values.low <= at_most) &
                        (magnitude(value) < infinity);
  return select(is_dark, EnclosureOf<Lanes>{}, select(is_known, value, anything_in<Lanes>({zero, at_most})));
}

}  // namespace
}  // namespace lambake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
