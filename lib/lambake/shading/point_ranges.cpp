#include "lambake/shading/point_ranges.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "lambake/core/parallel.h"

namespace lambake {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr std::size_t key_block = 1024;
constexpr std::size_t tile_size = RangeTree::tile_size, leaf_size = RangeTree::leaf_size,
                      n_children = RangeTree::n_children;

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

/// Stable radix sort by key: 9 bits a pass.
void sort_by_key(std::vector<KeyedPoint>& items) {
  constexpr int bits = 9;
  std::array<std::array<std::uint32_t, 1u << bits>, key_bits / bits> counts{};
  for (const KeyedPoint& item : items)
    for (std::size_t pass = 0; pass < counts.size(); ++pass)
      ++counts[pass][item.key >> (bits * pass) & ((1u << bits) - 1)];
  std::vector<KeyedPoint> other(items.size());
  for (std::size_t pass = 0; pass < counts.size(); ++pass) {
    std::uint32_t sum = 0;
    for (std::uint32_t& count : counts[pass]) sum += std::exchange(count, sum);
    for (const KeyedPoint& item : items)
      other[counts[pass][item.key >> (bits * pass) & ((1u << bits) - 1)]++] = item;
    items.swap(other);
  }
}

/// Cuts a range into such of at most `most` points, appended to `out`.
void split(std::span<const KeyedPoint> order, PointRange range, std::size_t most,
           std::vector<PointRange>& out) {
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
                             [cell](const KeyedPoint& point) { return point.key < cell; }) -
        order.begin());
  }
  split(order, {range.begin, middle}, most, out);
  split(order, {middle, range.end}, most, out);
}

/// Whether normals turn so quickly among neighbours that ranges of points anywhere in the tile which face
/// alike have less of a horizon, the directions that some of its points see and others do not, than ranges of
/// neighbours: both the spread of normals and the range's size over a light's distance (`unit`) widen it.
bool turns_quickly(std::span<const KeyedPoint> order, const PointRange& tile, float unit,
                   std::span<const glm::vec3> positions, std::span<const glm::vec3> normals) {
  constexpr std::size_t n_samples = 4;
  if (tile.size() < 2 * n_samples * leaf_size) return false;
  glm::vec3 least(infinity), most(-infinity);
  float spread = 0;
  for (std::size_t sample = 0; sample < n_samples; ++sample) {
    const std::size_t first = tile.begin + sample * (tile.size() - leaf_size) / (n_samples - 1);
    glm::vec3 least_normal(infinity), most_normal(-infinity);
    for (std::size_t i = first; i < first + leaf_size; ++i) {
      const glm::vec3 &p = positions[order[i].point], &n = normals[order[i].point];
      least = glm::min(least, p), most = glm::max(most, p);
      least_normal = glm::min(least_normal, n), most_normal = glm::max(most_normal, n);
    }
    const glm::vec3 extent = most_normal - least_normal;
    spread += std::max({extent.x, extent.y, extent.z}) / n_samples;
  }
  return spread * unit > glm::length(most - least);
}

/// The points of a tile by the way they face, in each half of it.
void sort_by_normal(std::span<const KeyedPoint> order, const PointRange& tile,
                    std::span<const glm::vec3> normals, RangeTree& tree) {
  std::vector<PointRange>& parts = tree.ranges[0];
  parts.clear();
  split(order, tile, tile_size / 2, parts);
  tree.by_normal.clear();
  for (std::size_t part = 0; part < parts.size(); ++part)
    for (std::size_t i = parts[part].begin; i < parts[part].end; ++i)
      tree.by_normal.push_back(
          {static_cast<std::uint32_t>(part) << normal_key_bits | key_of(normals[order[i].point]),
           order[i].point});
  sort_by_key(tree.by_normal);
}

/// Adds the nodes of a range of at most `most` points.
void add_nodes(std::span<const KeyedPoint> order, PointRange range, std::size_t most, std::size_t level,
               RangeTree& tree) {
  while (most > leaf_size && range.size() <= most / n_children) most /= n_children;
  const std::size_t node = tree.nodes.size();
  tree.nodes.push_back({tree.slots.size(), 0, 0});
  if (range.size() <= leaf_size) {
    for (std::size_t i = range.begin; i < range.end; ++i) tree.slots.push_back(order[i].point);
    tree.nodes[node].end = tree.slots.size();
    tree.slots.resize((tree.slots.size() + 15) / 16 * 16, tree.slots.back());
  } else {
    std::vector<PointRange>& parts = tree.ranges[level];
    parts.clear();
    split(order, range, most / n_children, parts);
    for (const PointRange& part : parts) add_nodes(order, part, most / n_children, level + 1, tree);
    tree.nodes[node].end = tree.slots.size();
  }
  tree.nodes[node].next = tree.nodes.size();
}

}  // namespace

std::vector<KeyedPoint> sort_points(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                                    const Bounds& box) {
  std::vector<KeyedPoint> items(positions.size());
  const glm::vec3 size = box.max - box.min;
  const float longest = std::max({size.x, size.y, size.z});
  const glm::vec3 cells(longest > 0 ? 256.0f / longest : 0.0f);
  parallel_blocks(items.size(), key_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      items[i] = {key_of(positions[i], normals[i], box, cells), static_cast<std::uint32_t>(i)};
  });
  sort_by_key(items);
  while (!items.empty() && items.back().key == key_of_unlit) items.pop_back();
  return items;
}

std::vector<PointRange> cut_into_tiles(std::span<const KeyedPoint> order) {
  std::vector<PointRange> tiles;
  if (!order.empty()) split(order, {0, order.size()}, tile_size, tiles);
  return tiles;
}

void build_range_tree(std::span<const KeyedPoint> order, const PointRange& tile, float unit,
                      std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                      RangeTree& tree) {
  tree.nodes.clear(), tree.slots.clear();
  if (turns_quickly(order, tile, unit, positions, normals)) {
    sort_by_normal(order, tile, normals, tree);
    add_nodes(tree.by_normal, {0, tree.by_normal.size()}, tile_size, 0, tree);
  } else {
    add_nodes(order, tile, tile_size, 0, tree);
  }
}

}  // namespace lambake
