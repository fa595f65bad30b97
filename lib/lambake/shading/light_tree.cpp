#include "lambake/shading/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "lambake/core/bounds.h"
#include "lambake/core/parallel.h"
#include "lambake/shading/light_cut.h"
#include "lambake/shading/light_field.h"
#include "lambake/shading/light_kernel.h"
#include "lambake/shading/point_ranges.h"

namespace lambake {
namespace {

constexpr std::size_t plain_block = 1024;
/// Below so many lights of falloff 1/d² the plain sum is faster (docs/performance.md).
constexpr std::size_t fewest_lights = 512;
constexpr std::size_t fewest_points = 1024;
/// The share of the tolerance for ranges above the smallest, which use the rest of it.
constexpr float own_light_budget = 0.6f;

bool is_inverse_square(const Light& light) {
  return light.type == LightType::point && light.decay == 2 && !(light.range > 0);
}

void sum_plainly(const PackedLights& lights, std::span<const glm::vec3> positions,
                 std::span<const glm::vec3> normals, std::span<LinearRgb> out) {
  parallel_blocks(out.size(), plain_block, [&](std::size_t begin, std::size_t end) {
    const std::size_t n = end - begin;
    irradiance(lights, lights.needs_positions ? positions.subspan(begin, n) : positions,
               normals.subspan(begin, n), out.subspan(begin, n));
  });
}

/// World space to the space of the tree: around the points, so long that all points and lights are within 1.
struct Frame {
  glm::dvec3 center{0};
  double scale = 1;
  glm::vec3 operator()(const glm::vec3& p) const { return glm::vec3((glm::dvec3(p) - center) * scale); }
};

Frame frame_of(const Bounds& points, std::span<const Light> lights) {
  Frame frame;
  frame.center = (glm::dvec3(points.min) + glm::dvec3(points.max)) * 0.5;
  double radius = glm::length(glm::dvec3(points.max) - frame.center);
  for (const Light& light : lights)
    radius = std::max(radius, glm::length(glm::dvec3(light.position) - frame.center));
  if (radius > 0) frame.scale = 1 / radius;
  return frame;
}

/// In the space of the tree; above it all lights are summed, as light and its sums might overflow.
constexpr float greatest_intensity = 1e30f;

LightArrays lights_in(const Frame& frame, std::span<const Light> lights) {
  LightArrays arrays;
  arrays.reserve(lights.size());
  const double unit = frame.scale * frame.scale;
  // Rounded up to a float that has all its digits: a light that is black can be left out, however near.
  const auto intensity = [&](float of_channel) {
    return of_channel > 0 ? std::max(static_cast<float>(of_channel * unit), std::numeric_limits<float>::min())
                          : 0.0f;
  };
  for (const Light& light : lights) {
    const std::size_t i = arrays.size++;
    const glm::vec3 p = frame(light.position);
    arrays.x[i] = p.x, arrays.y[i] = p.y, arrays.z[i] = p.z;
    arrays.r[i] = intensity(light.intensity.r);
    arrays.g[i] = intensity(light.intensity.g);
    arrays.b[i] = intensity(light.intensity.b);
    arrays.index[i] = static_cast<std::uint32_t>(i);
  }
  return arrays;
}

/// A linear error of this moves no encoded value by more than `tolerance_display` where the light is at least
/// `lower`: the sRGB curve is concave, with slope 12.92 at black.
float allowed_error(double tolerance_display, float lower) {
  const double dark = 0.9 * lower;
  const double least = tolerance_display / 12.92;
  if (dark <= 0.0031308) return static_cast<float>(least);
  const double slope = 1.055 / 2.4 * std::pow(dark, 1 / 2.4 - 1);
  return static_cast<float>(std::max(least, std::min(tolerance_display / slope, 0.1 * lower)));
}

/// What one thread needs for a tile.
struct Workspace {
  RangeTree tree;
  PointArrays points;  ///< By slot, as is what follows.
  std::vector<float> normal_lengths;
  std::vector<glm::vec3> positions, normals;  ///< As given, for the plain sums.
  std::vector<LinearRgb> sums;
  LightWeights weights;
  LightArrays merged;
  std::array<LightArrays, RangeTree::n_levels> rest;  ///< By level.
  std::array<std::vector<PointBounds>, RangeTree::n_levels>
      bounds;  ///< Of the children of a node of that level.
  std::array<std::vector<LightField>, RangeTree::n_levels> fields;  ///< The same.
  PackedLights near;
};

struct Tile {
  const PackedLights& sources;  ///< The lights of falloff 1/d², in world space.
  double tolerance_display;
  Workspace& work;
  LightError error;

  /// What levels above have done: the sum of their shares, their errors, and a lower bound of the light that
  /// they dealt with.
  struct Past {
    float share = 0;
    std::array<double, 3> error{};
    std::array<float, 3> lower{};
  };

  void visit(const LightArrays& lights, std::size_t node, std::size_t level, Past past,
             const PointBounds& bounds, LightField& field);
  void sum_rest(const LightArrays& lights, std::size_t begin, std::size_t end);
};

void Tile::visit(const LightArrays& lights, std::size_t node, std::size_t level, Past past,
                 const PointBounds& bounds, LightField& field) {
  const std::vector<RangeTree::Node>& nodes = work.tree.nodes;
  const auto [begin, end, next] = nodes[node];
  LightArrays& rest = work.rest[level];
  rest.reserve(lights.size);
  const bool is_leaf = work.tree.is_leaf(node);
  const LightArrays* left = &lights;
  if (bounds.is_cone()) {
    work.weights.reserve(lights.size);
    const std::array<float, 3> lower = weigh_lights(lights, bounds, work.weights);
    std::array<float, 3> allowed;
    for (std::size_t c = 0; c < 3; ++c)
      allowed[c] = allowed_error(tolerance_display, past.lower[c] + lower[c]);
    work.merged.reserve(lights.size);
    Cut cut;
    if (!is_leaf)
      cut = cut_lights(
          lights, work.weights, allowed,
          line_by_own_light(lights, work.weights, allowed, std::max(0.0f, own_light_budget - past.share)),
          work.merged, rest);
    // Near lights are nearer to some ranges than to others: what stood on the line above may be over it here.
    if (is_leaf || past.share + cut.share > 1.0f)
      cut = cut_lights(lights, work.weights, allowed,
                       line_by_error(lights, work.weights, allowed, 1.0f - past.share), work.merged, rest);
    past.share += cut.share;
    for (std::size_t c = 0; c < 3; ++c) past.error[c] += cut.error[c], past.lower[c] += cut.lower[c];
    if (work.merged.size > 0) add_lights(field, work.merged);
    left = &rest;
  }
  if (!is_leaf) {
    std::vector<PointBounds>& child_bounds = work.bounds[level];
    std::vector<LightField>& child_fields = work.fields[level];
    child_bounds.clear(), child_fields.clear();
    for (std::size_t child = node + 1; child < next; child = nodes[child].next) {
      child_bounds.push_back(bound_points(work.points, nodes[child].begin, nodes[child].end));
      child_fields.push_back({.center = child_bounds.back().center, .radius = child_bounds.back().radius});
    }
    translate(field, child_fields);
    std::size_t i = 0;
    for (std::size_t child = node + 1; child < next; child = nodes[child].next, ++i)
      visit(*left, child, level + 1, past, child_bounds[i], child_fields[i]);
    return;
  }
  add_irradiance(field, work.points, begin, end);
  error.display = std::max(error.display, past.share * tolerance_display);
  for (const double e : past.error) error.linear = std::max(error.linear, e);
  sum_rest(*left, begin, end);
}

void Tile::sum_rest(const LightArrays& lights, std::size_t begin, std::size_t end) {
  PackedLights& near = work.near;
  near.sources.clear();
  for (std::size_t i = 0; i < lights.size; ++i) near.sources.push_back(sources.sources[lights.index[i]]);
  near.needs_positions = true;
  near.runs.assign(1, {PackedLights::Kind::inverse_square, 0, lights.size, 0});
  const std::size_t n = end - begin;
  irradiance(near, std::span(work.positions).subspan(begin, n), std::span(work.normals).subspan(begin, n),
             std::span(work.sums).subspan(begin, n));
}

/// The points of the tile's slots, in the space of the tree, without light yet.
void load_points(const Frame& frame, std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                 Workspace& work) {
  const std::vector<std::uint32_t>& slots = work.tree.slots;
  const std::size_t n = slots.size();
  work.normal_lengths.resize(n);
  work.positions.resize(n), work.normals.resize(n), work.sums.resize(n);
  PointArrays& points = work.points;
  points.resize(n);
  for (std::size_t i = 0; i < n; ++i)
    work.positions[i] = positions[slots[i]], work.normals[i] = normals[slots[i]];
  for (std::size_t i = 0; i < n; ++i) {
    const glm::vec3 p = frame(work.positions[i]);
    const float length = glm::length(work.normals[i]);
    const glm::vec3 normal = work.normals[i] * (1.0f / length);
    work.normal_lengths[i] = length;
    points.x[i] = p.x, points.y[i] = p.y, points.z[i] = p.z;
    points.nx[i] = normal.x, points.ny[i] = normal.y, points.nz[i] = normal.z;
    points.r[i] = points.g[i] = points.b[i] = 0;
  }
}

}  // namespace

LightError irradiance_within(std::span<const Light> lights, double tolerance_display,
                             std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                             std::span<LinearRgb> out) {
  std::vector<Light> many, others;
  if (tolerance_display > 0 && lights.size() >= fewest_lights && out.size() >= fewest_points)
    for (const Light& light : lights) (is_inverse_square(light) ? many : others).push_back(light);
  const Bounds box = many.size() < fewest_lights ? Bounds() : bounds_of(positions);
  const Frame frame = box.is_empty() ? Frame() : frame_of(box, many);
  const auto is_too_bright = [&](const Light& light) {
    const auto& [r, g, b] = light.intensity;
    return std::max({r, g, b}) * frame.scale * frame.scale > greatest_intensity;
  };
  if (many.size() < fewest_lights || box.is_empty() || std::any_of(many.begin(), many.end(), is_too_bright)) {
    sum_plainly(pack_lights(lights), positions, normals, out);
    return {};
  }
  sum_plainly(pack_lights(others), positions, normals, out);

  const LightArrays sources = lights_in(frame, many);
  const PackedLights packed = pack_lights(many);
  const std::vector<KeyedPoint> order = sort_points(positions, normals, box);
  const std::vector<PointRange> tiles = cut_into_tiles(order);
  std::vector<LightError> errors(tiles.size());
  parallel_blocks(tiles.size(), 1, [&](std::size_t tile, std::size_t) {
    static thread_local Workspace work;  // its memory is used again, its contents are not
    const RangeTree& tree = work.tree;
    build_range_tree(order, tiles[tile], static_cast<float>(1 / frame.scale), positions, normals, work.tree);
    load_points(frame, positions, normals, work);
    Tile t{packed, tolerance_display, work, {}};
    const PointBounds bounds = bound_points(work.points, 0, tree.nodes[0].end);
    LightField field{.center = bounds.center, .radius = bounds.radius};
    t.visit(sources, 0, 0, {}, bounds, field);
    errors[tile] = t.error;
    const PointArrays& points = work.points;
    for (std::size_t node = 0; node < tree.nodes.size(); ++node) {
      if (!tree.is_leaf(node)) continue;
      for (std::size_t i = tree.nodes[node].begin; i < tree.nodes[node].end; ++i) {
        const float length = work.normal_lengths[i];
        // A field that is out by its error may be below what light can be.
        const LinearRgb merged{std::max(0.0f, points.r[i] * length), std::max(0.0f, points.g[i] * length),
                               std::max(0.0f, points.b[i] * length)};
        out[tree.slots[i]] += merged + work.sums[i];
      }
    }
  });
  LightError worst;
  for (const LightError& e : errors)
    worst = {std::max(worst.linear, e.linear), std::max(worst.display, e.display)};
  return worst;
}

}  // namespace lambake
