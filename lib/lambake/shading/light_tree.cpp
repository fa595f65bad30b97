#include "lambake/shading/light_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "lambake/core/bounds.h"
#include "lambake/core/parallel.h"
#include "lambake/shading/light_cut.h"
#include "lambake/shading/light_field.h"
#include "lambake/shading/light_kernel.h"

namespace lambake {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr std::size_t plain_block = 1024;
/// At most so many points are dealt with together at first, and at last; each level has a quarter of the
/// points of the one above.
constexpr std::size_t tile_size = 8192, leaf_size = 128, n_children = 4;
constexpr std::size_t n_levels = 4;
static_assert(tile_size == leaf_size * n_children * n_children * n_children);
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

/// The lower 8 bits of v, two zeros between each and the next.
std::uint32_t spread_bits(std::uint32_t v) {
  v = (v | (v << 8)) & 0x0000F00Fu;
  v = (v | (v << 4)) & 0x000C30C3u;
  return (v | (v << 2)) & 0x00249249u;
}

/// The same with one zero between.
std::uint32_t spread_pairs(std::uint32_t v) {
  v = (v | (v << 4)) & 0x0F0Fu;
  v = (v | (v << 2)) & 0x3333u;
  return (v | (v << 1)) & 0x5555u;
}

/// Which of six ways a normal faces: its largest axis and that one's sign.
struct Face {
  int axis;
  bool is_negative;
  std::uint32_t index() const { return static_cast<std::uint32_t>(2 * axis + is_negative); }
};

Face face_of(const glm::vec3& normal) {
  const glm::vec3 a = glm::abs(normal);
  const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
  return {axis, normal[axis] < 0};
}

constexpr int key_bits = 27, normal_key_bits = 19;
constexpr std::uint32_t key_of_unlit = 6u << 24;  ///< Points that no positional light can reach sort last.

/// Points with near keys lie near each other and face the same of six ways: the normal's largest axis, then
/// the Morton code of the position.
std::uint32_t key_of(const glm::vec3& position, const glm::vec3& normal, const Bounds& box,
                     const glm::vec3& cells) {
  const float length_squared = glm::dot(normal, normal);
  if (!is_finite(position) || !(std::abs(length_squared - 1.0f) < 1e-3f)) return key_of_unlit;
  const glm::vec3 cell = glm::clamp((position - box.min) * cells, 0.0f, 255.0f);
  return face_of(normal).index() << 24 | spread_bits(static_cast<std::uint32_t>(cell.x)) << 2 |
         spread_bits(static_cast<std::uint32_t>(cell.y)) << 1 |
         spread_bits(static_cast<std::uint32_t>(cell.z));
}

/// The same by the normal alone, as the Morton code of its other two axes: `normal_key_bits`.
std::uint32_t key_of(const glm::vec3& normal) {
  const Face face = face_of(normal);
  const auto cell = [&](int offset) {
    return static_cast<std::uint32_t>(
        glm::clamp((normal[(face.axis + offset) % 3] + 1) * 128.0f, 0.0f, 255.0f));
  };
  return face.index() << 16 | spread_pairs(cell(1)) << 1 | spread_pairs(cell(2));
}

struct Keyed {
  std::uint32_t key, point;
};

/// Stable radix sort by key: 9 bits a pass.
void sort_by_key(std::vector<Keyed>& items) {
  constexpr int bits = 9;
  std::array<std::array<std::uint32_t, 1u << bits>, key_bits / bits> counts{};
  for (const Keyed& item : items)
    for (std::size_t pass = 0; pass < counts.size(); ++pass)
      ++counts[pass][item.key >> (bits * pass) & ((1u << bits) - 1)];
  std::vector<Keyed> other(items.size());
  for (std::size_t pass = 0; pass < counts.size(); ++pass) {
    std::uint32_t sum = 0;
    for (std::uint32_t& count : counts[pass]) sum += std::exchange(count, sum);
    for (const Keyed& item : items)
      other[counts[pass][item.key >> (bits * pass) & ((1u << bits) - 1)]++] = item;
    items.swap(other);
  }
}

std::vector<Keyed> sort_points(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                               const Bounds& box) {
  std::vector<Keyed> items(positions.size());
  const glm::vec3 size = box.max - box.min;
  const float longest = std::max({size.x, size.y, size.z});
  const glm::vec3 cells(longest > 0 ? 256.0f / longest : 0.0f);
  parallel_blocks(items.size(), plain_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      items[i] = {key_of(positions[i], normals[i], box, cells), static_cast<std::uint32_t>(i)};
  });
  sort_by_key(items);
  return items;
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

/// Sorted points [begin, end).
struct Range {
  std::size_t begin, end;
  std::size_t size() const { return end - begin; }
};

/// Cuts a range into such of at most `most` points, between the cells of its keys rather than anywhere: a
/// range over the border of two large cells would be wide. What is small joins its neighbour.
void split(std::span<const Keyed> order, Range range, std::size_t most, std::vector<Range>& out) {
  if (range.size() <= most) {
    if (!out.empty() && out.back().end == range.begin && range.end - out.back().begin <= most)
      out.back().end = range.end;
    else
      out.push_back(range);
    return;
  }
  const std::uint32_t first = order[range.begin].key, last = order[range.end - 1].key;
  std::size_t middle = range.begin + range.size() / 2;
  if (first != last) {
    const std::uint32_t cell = last & ~(std::bit_floor(first ^ last) - 1);  // the upper one's first key
    middle = static_cast<std::size_t>(
        std::partition_point(order.begin() + static_cast<std::ptrdiff_t>(range.begin),
                             order.begin() + static_cast<std::ptrdiff_t>(range.end),
                             [cell](const Keyed& point) { return point.key < cell; }) -
        order.begin());
  }
  split(order, {range.begin, middle}, most, out);
  split(order, {middle, range.end}, most, out);
}

/// Whether normals turn so quickly among neighbours that ranges of points anywhere in the tile which face
/// alike have less of a horizon, the directions that some of its points see and others do not, than ranges of
/// neighbours: both the spread of normals and the range's size over a light's distance (1, here) widen it.
bool turns_quickly(std::span<const Keyed> order, const Range& tile, const Frame& frame,
                   std::span<const glm::vec3> positions, std::span<const glm::vec3> normals) {
  constexpr std::size_t n_samples = 4;
  if (tile.size() < 2 * n_samples * leaf_size) return false;
  glm::vec3 least(infinity), most(-infinity);
  float spread = 0;
  for (std::size_t sample = 0; sample < n_samples; ++sample) {
    const std::size_t first = tile.begin + sample * (tile.size() - leaf_size) / (n_samples - 1);
    glm::vec3 least_normal(infinity), most_normal(-infinity);
    for (std::size_t i = first; i < first + leaf_size; ++i) {
      const glm::vec3 p = frame(positions[order[i].point]), n = normals[order[i].point];
      least = glm::min(least, p), most = glm::max(most, p);
      least_normal = glm::min(least_normal, n), most_normal = glm::max(most_normal, n);
    }
    const glm::vec3 extent = most_normal - least_normal;
    spread += std::max({extent.x, extent.y, extent.z}) / n_samples;
  }
  return spread > glm::length(most - least);
}

/// A range of a tile's slots, in depth-first order: a node's first child follows it.
struct Node {
  std::size_t begin, end;  ///< Slots; `begin` is a multiple of 16.
  std::size_t next;        ///< The node after all below this one.
};

/// What one thread needs for a tile.
struct Workspace {
  std::vector<Keyed> by_normal;  ///< The tile's points, where they turn quickly.
  std::vector<Node> nodes;
  std::vector<std::uint32_t> slots;  ///< The points; each leaf is filled up to 16 with its last one.
  std::array<std::vector<Range>, n_levels> ranges;  ///< By level.
  PointArrays points;                               ///< By slot, as is what follows.
  std::vector<float> normal_lengths;
  std::vector<glm::vec3> positions, normals;  ///< As given, for the plain sums.
  std::vector<LinearRgb> sums;
  LightWeights weights;
  LightArrays merged;
  std::array<LightArrays, n_levels> rest;                 ///< By level.
  std::array<std::vector<PointBounds>, n_levels> bounds;  ///< Of the children of a node of that level.
  std::array<std::vector<LightField>, n_levels> fields;   ///< The same.
  PackedLights near;
};

/// The points of a tile by the way they face, in each half of it.
void sort_by_normal(std::span<const Keyed> order, const Range& tile, std::span<const glm::vec3> normals,
                    Workspace& work) {
  std::vector<Range>& parts = work.ranges[0];
  parts.clear();
  split(order, tile, tile_size / 2, parts);
  work.by_normal.clear();
  for (std::size_t part = 0; part < parts.size(); ++part)
    for (std::size_t i = parts[part].begin; i < parts[part].end; ++i)
      work.by_normal.push_back(
          {static_cast<std::uint32_t>(part) << normal_key_bits | key_of(normals[order[i].point]),
           order[i].point});
  sort_by_key(work.by_normal);
}

/// Adds the nodes of a range of at most `most` points.
void add_nodes(std::span<const Keyed> order, Range range, std::size_t most, std::size_t level,
               Workspace& work) {
  while (most > leaf_size && range.size() <= most / n_children) most /= n_children;
  const std::size_t node = work.nodes.size();
  work.nodes.push_back({work.slots.size(), 0, 0});
  if (range.size() <= leaf_size) {
    for (std::size_t i = range.begin; i < range.end; ++i) work.slots.push_back(order[i].point);
    work.nodes[node].end = work.slots.size();
    work.slots.resize((work.slots.size() + 15) / 16 * 16, work.slots.back());
  } else {
    std::vector<Range>& parts = work.ranges[level];
    parts.clear();
    split(order, range, most / n_children, parts);
    for (const Range& part : parts) add_nodes(order, part, most / n_children, level + 1, work);
    work.nodes[node].end = work.slots.size();
  }
  work.nodes[node].next = work.nodes.size();
}

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
  const auto [begin, end, next] = work.nodes[node];
  LightArrays& rest = work.rest[level];
  rest.reserve(lights.size);
  const bool is_leaf = next == node + 1;
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
    for (std::size_t child = node + 1; child < next; child = work.nodes[child].next) {
      child_bounds.push_back(bound_points(work.points, work.nodes[child].begin, work.nodes[child].end));
      child_fields.push_back({.center = child_bounds.back().center, .radius = child_bounds.back().radius});
    }
    translate(field, child_fields);
    std::size_t i = 0;
    for (std::size_t child = node + 1; child < next; child = work.nodes[child].next, ++i)
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
  const std::size_t n = work.slots.size();
  work.normal_lengths.resize(n);
  work.positions.resize(n), work.normals.resize(n), work.sums.resize(n);
  PointArrays& points = work.points;
  points.resize(n);
  for (std::size_t i = 0; i < n; ++i)
    work.positions[i] = positions[work.slots[i]], work.normals[i] = normals[work.slots[i]];
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
  if (many.size() < fewest_lights || box.is_empty()) {
    sum_plainly(pack_lights(lights), positions, normals, out);
    return {};
  }
  sum_plainly(pack_lights(others), positions, normals, out);

  const Frame frame = frame_of(box, many);
  const double unit = frame.scale * frame.scale;
  LightArrays sources;
  sources.reserve(many.size());
  for (const Light& light : many) {
    const std::size_t i = sources.size++;
    const glm::vec3 p = frame(light.position);
    sources.x[i] = p.x, sources.y[i] = p.y, sources.z[i] = p.z;
    sources.r[i] = static_cast<float>(light.intensity.r * unit);
    sources.g[i] = static_cast<float>(light.intensity.g * unit);
    sources.b[i] = static_cast<float>(light.intensity.b * unit);
    sources.index[i] = static_cast<std::uint32_t>(i);
  }
  const PackedLights packed = pack_lights(many);
  const std::vector<Keyed> order = sort_points(positions, normals, box);
  std::size_t n_lit = order.size();
  while (n_lit > 0 && order[n_lit - 1].key == key_of_unlit) --n_lit;

  std::vector<Range> tiles;
  if (n_lit > 0) split(order, {0, n_lit}, tile_size, tiles);
  std::vector<LightError> errors(tiles.size());
  parallel_blocks(tiles.size(), 1, [&](std::size_t tile, std::size_t) {
    static thread_local Workspace work;  // its memory is used again, its contents are not
    work.nodes.clear(), work.slots.clear();
    if (turns_quickly(order, tiles[tile], frame, positions, normals)) {
      sort_by_normal(order, tiles[tile], normals, work);
      add_nodes(work.by_normal, {0, work.by_normal.size()}, tile_size, 0, work);
    } else {
      add_nodes(order, tiles[tile], tile_size, 0, work);
    }
    load_points(frame, positions, normals, work);
    Tile t{packed, tolerance_display, work, {}};
    const PointBounds bounds = bound_points(work.points, 0, work.nodes[0].end);
    LightField field{.center = bounds.center, .radius = bounds.radius};
    t.visit(sources, 0, 0, {}, bounds, field);
    errors[tile] = t.error;
    const PointArrays& points = work.points;
    for (std::size_t node = 0; node < work.nodes.size(); ++node) {
      if (work.nodes[node].next != node + 1) continue;
      for (std::size_t i = work.nodes[node].begin; i < work.nodes[node].end; ++i) {
        const float length = work.normal_lengths[i];
        // A field that is out by its error may be below what light can be.
        const LinearRgb merged{std::max(0.0f, points.r[i] * length), std::max(0.0f, points.g[i] * length),
                               std::max(0.0f, points.b[i] * length)};
        out[work.slots[i]] += merged + work.sums[i];
      }
    }
  });
  LightError worst;
  for (const LightError& e : errors)
    worst = {std::max(worst.linear, e.linear), std::max(worst.display, e.display)};
  return worst;
}

}  // namespace lambake
