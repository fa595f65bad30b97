#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lambake/scene/light.h"

namespace lambake {

/// What decides how a light is enclosed.
struct LightKind {
  LightType type = LightType::directional;
  bool has_range = false;
  double decay = 0;
  auto operator<=>(const LightKind&) const = default;
};

/// Up to four lights of one kind, number by number for vectors. The last one fills up the block, without
/// intensity.
struct LightBlock {
  static constexpr std::size_t size = 4;
  LightKind kind;
  std::size_t n = 0;
  std::uint32_t lights[size] = {};                              ///< Their indices.
  alignas(32) double x[size] = {}, y[size] = {}, z[size] = {};  ///< Position, or direction to the light.
  alignas(32) double range[size] = {};                          ///< 0 is none.
  alignas(32) double axis_x[size] = {}, axis_y[size] = {}, axis_z[size] = {};  ///< Of a spot.
  /// outer of the cone as a bound on axis·ω, and what the ramp of the cone is scaled with (lambert.h).
  alignas(32) double cos_outer[size] = {}, cone_scale[size] = {};
  alignas(32) double intensity[3][size] = {};  ///< By channel.
  alignas(32) double brightest[size] = {};     ///< The largest of its channels.
};

/// The lights of `all` with the given indices, in blocks: by kind, in the order of the indices.
std::vector<LightBlock> light_blocks(std::span<const Light> all, std::span<const std::uint32_t> lights);

}  // namespace lambake
