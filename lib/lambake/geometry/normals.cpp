#include "lambake/geometry/normals.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>

#include "lambake/core/bounds.h"
#include "lambake/core/parallel.h"
#include "lambake/geometry/normal_sums.h"

namespace lambake {
namespace {

constexpr std::size_t block_size = 4096;

glm::dvec3 area_vector(const Mesh& mesh, std::size_t f) {
  const glm::uvec3& t = mesh.triangles[f];
  return lambake::area_vector(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]);
}

/// A power of two near the size of the mesh, by a thousand of its vertices.
float unit_of(std::span<const glm::vec3> positions) {
  Bounds box;
  const std::size_t step = std::max<std::size_t>(1, positions.size() / 1000);
  for (std::size_t i = 0; i < positions.size(); i += step)
    if (is_finite(positions[i]))
      box.min = glm::min(box.min, positions[i]), box.max = glm::max(box.max, positions[i]);
  const glm::vec3 size = box.max - box.min;
  const float largest = std::max({size.x, size.y, size.z});
  if (!(largest > 0) || !std::isfinite(largest)) return 1;
  return std::ldexp(1.0f, std::clamp(std::ilogb(largest), -100, 100));
}

/// Consecutive faces.
struct Chunk {
  std::size_t begin, end;
  IndexRange groups;  // That they name.
};

/// What vertex_normals() works on: the faces, and the groups of vertices that get one normal each.
///
/// Windows of groups are done side by side, each by all faces that name one of its groups, in their order. A
/// face at the border of windows is computed for each of them.
class GroupNormals {
 public:
  GroupNormals(const Mesh& mesh, NormalWeight weight)
      : mesh_(mesh),
        weight_(weight),
        unit_(unit_of(mesh.positions)),
        group_of_(mesh.shared_normals()),
        n_groups_(count_of_numbers(mesh.shared_normals(), mesh.n_vertices())),
        chunks_((mesh.n_triangles() + chunk_size - 1) / chunk_size) {
    parallel_blocks(mesh.n_triangles(), chunk_size, [&](std::size_t begin, std::size_t end) {
      chunks_[begin / chunk_size] = {begin, end, index_range(faces_from(begin, end), group_of_)};
    });
  }

  VertexNormals run() {
    VertexNormals result;
    result.normals.resize(n_groups_);
    std::atomic<std::size_t> n_without{0};
    parallel_blocks(n_groups_, window_size(), [&](std::size_t begin, std::size_t end) {
      n_without += sum_window(begin, std::span(result.normals).subspan(begin, end - begin));
    });
    if (!group_of_.empty()) {
      std::vector<glm::vec3> normals(mesh_.n_vertices());
      for (std::size_t v = 0; v < normals.size(); ++v) normals[v] = result.normals[group_of_[v]];
      result.normals = std::move(normals);
    }
    if (n_without > 0) result.undefined = count_undefined(result.normals);
    return result;
  }

 private:
  static constexpr std::size_t chunk_size = 2048;

  std::span<const glm::uvec3> faces_from(std::size_t begin, std::size_t end) const {
    return std::span(mesh_.triangles).subspan(begin, end - begin);
  }

  template <typename Body>
  void for_each_chunk(std::size_t first_group, std::size_t n, const Body& body) const {
    for (const Chunk& chunk : chunks_)
      if (chunk.groups.last >= first_group && chunk.groups.first < first_group + n)
        body(faces_from(chunk.begin, chunk.end), chunk.groups);
  }

  /// Groups in a window: several windows for each thread, but not so small that many faces lie at their
  /// borders, and are computed twice, nor so large that their sums leave the cache. Where neighbours are not
  /// numbered alike, so that most chunks meet most windows, one window for each thread.
  std::size_t window_size() const {
    constexpr std::size_t least = 16384, greatest = 131072;
    const std::size_t size = std::clamp(n_groups_ / (4 * thread_count()), least, greatest);
    std::size_t n_meetings = 0;
    for (const Chunk& chunk : chunks_) n_meetings += chunk.groups.last / size - chunk.groups.first / size + 1;
    if (n_meetings <= 2 * chunks_.size()) return size;
    return std::max(size, (n_groups_ + thread_count() - 1) / thread_count());
  }

  /// @returns how many of the groups have no direction.
  std::size_t sum_window(std::size_t first, std::span<glm::vec3> normals) const {
    const auto storage = std::make_unique_for_overwrite<NormalSum[]>(normals.size());
    const NormalWindow window{
        group_of_, static_cast<std::uint32_t>(first), {storage.get(), normals.size()}, unit_};
    std::fill(window.sums.begin(), window.sums.end(), NormalSum{});
    for_each_chunk(first, normals.size(), [&](std::span<const glm::uvec3> triangles, IndexRange named) {
      add_faces(mesh_.positions, triangles, weight_, window, named);
    });
    UnitNormalCounts counts = unit_normals(window.sums, normals);
    if (counts.n_uncertain > 0) {
      sum_uncertain_again(window);
      counts = unit_normals(window.sums, normals);
    }
    return counts.n_without;
  }

  void sum_uncertain_again(const NormalWindow& window) const {
    std::vector<char> is_wanted(window.sums.size());
    for (std::size_t i = 0; i < is_wanted.size(); ++i) {
      is_wanted[i] = is_uncertain(window.sums[i]);
      if (is_wanted[i] != 0) window.sums[i] = NormalSum{};
    }
    for_each_chunk(window.first, is_wanted.size(), [&](std::span<const glm::uvec3> triangles, IndexRange) {
      add_faces_exactly(mesh_.positions, triangles, weight_, window, is_wanted);
    });
  }

  /// Vertices of a face that have no direction.
  std::size_t count_undefined(std::span<const glm::vec3> normals) const {
    const auto group = [&](std::uint32_t v) { return group_of_.empty() ? v : group_of_[v]; };
    std::vector<bool> is_used(n_groups_, false);
    for (const glm::uvec3& t : mesh_.triangles)
      for (int c = 0; c < 3; ++c) is_used[group(t[c])] = true;
    std::size_t n = 0;
    for (std::uint32_t v = 0; v < normals.size(); ++v) n += normals[v] == glm::vec3(0) && is_used[group(v)];
    return n;
  }

  const Mesh& mesh_;
  NormalWeight weight_;
  float unit_;
  std::span<const std::uint32_t> group_of_;  // By vertex, or none: each its own.
  std::size_t n_groups_;
  std::vector<Chunk> chunks_;
};

}  // namespace

VertexNormals vertex_normals(const Mesh& mesh, NormalWeight weight) {
  return GroupNormals(mesh, weight).run();
}

std::vector<glm::vec3> face_normals(const Mesh& mesh) {
  std::vector<glm::vec3> normals(mesh.n_triangles(), glm::vec3(0));
  parallel_blocks(mesh.n_triangles(), block_size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const glm::dvec3 cross = area_vector(mesh, f);
      const double length = glm::length(cross);
      if (length > 0) normals[f] = glm::vec3(cross / length);
    }
  });
  return normals;
}

}  // namespace lambake
