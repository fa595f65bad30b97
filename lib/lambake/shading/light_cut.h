#pragma once

#include <array>
#include <cstddef>

#include "lambake/shading/light_field.h"

namespace lambake {

/// Where a range of points is and which way it faces.
struct PointBounds {
  glm::vec3 center{0};
  float radius = 0;                                  ///< Of the ball around `center`.
  glm::vec3 axis{0};                                 ///< Middle of the normals.
  float cos_cone = -1, sin_cone = 0;                 ///< Of the half angle of the cone around them.
  float min_elevation = 0, max_elevation = 0;        ///< Of n·(p − center): the bend of the surface.
  bool is_cone() const { return cos_cone > 0.05f; }  ///< Otherwise there is no horizon to speak of.
};

/// Points [begin, end) of `points`; `begin` a multiple of 16. Normals are unit to rounding. O(end − begin).
PointBounds bound_points(const PointArrays& points, std::size_t begin, std::size_t end);

/// What each of N lights may do to the points of some bounds; N + padding entries each.
struct LightWeights {
  std::vector<float>
      error;  ///< |error| of dealing with it at once, per intensity; infinity where that cannot be.
  std::vector<float> own;  ///< 1/d²: the size of its light, per intensity; 0 where it is behind all points.
  std::vector<float> is_merged;  ///< 1: into the field, 0: left out.
  std::vector<float> least;      ///< It gives at least this to every point, per intensity.
  void reserve(std::size_t n);   ///< Room for N lights.
};

/// Computes the weights; returns, by channel, a lower bound of what all `lights` give to every point.
std::array<float, 3> weigh_lights(const LightArrays& lights, const PointBounds& bounds,
                                  LightWeights& weights);

/// How a range's lights were dealt with.
struct Cut {
  std::array<float, 3> error{};  ///< By channel: at most so far off, for the lights merged and left out.
  std::array<float, 3> lower{};  ///< By channel: the merged lights give at least this to every point.
  float share = 0;               ///< Sum over the lights of max over the channels of error / allowed.
};

/// Where to draw the line between lights that are dealt with at once and those left for smaller ranges.
struct CutLine {
  enum class By {
    own_light,  ///< error <= level · I/d²: what a light costs later falls with its distance as its light
                ///< does.
    error       ///< error <= level: when there is no later, as many as possible.
  };
  By by = By::own_light;
  float level = 0;
};

/// The line by `own_light` that spends `budget` if all lights come to stand on it.
CutLine line_by_own_light(const LightArrays& lights, const LightWeights& weights,
                          const std::array<float, 3>& allowed, float budget);

/// The highest of a few lines by `error` that keeps the sum of the shares within `budget`.
CutLine line_by_error(const LightArrays& lights, const LightWeights& weights,
                      const std::array<float, 3>& allowed, float budget);

/// Sorts `lights` into those merged, those left out, and those left for smaller ranges (`rest`).
Cut cut_lights(const LightArrays& lights, const LightWeights& weights, const std::array<float, 3>& allowed,
               CutLine line, LightArrays& merged, LightArrays& rest);

}  // namespace lambake
