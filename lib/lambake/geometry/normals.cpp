#include "lambake/geometry/normals.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <mutex>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

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
  std::size_t first_window, last_window;   // Of the groups that the faces name, by a few of them or by all.
  std::vector<std::size_t> other_windows;  // That the others name too, as add_faces() finds.
};

/// Groups with consecutive numbers, from `first` on.
struct Window {
  std::size_t first, n;
  std::vector<std::size_t> chunks;  // With faces that name them.
};

/// What vertex_normals() works on: the faces, and the groups of vertices that get one normal each.
///
/// Windows of groups are done side by side, each by all faces that name one of its groups, in their order. A
/// face at the border of windows is computed for each of them. Which chunks of faces a window needs is
/// guessed by a few faces of each; where the others name more, the windows that missed a chunk are done
/// again, which costs as much as it does at first.
class GroupNormals {
 public:
  GroupNormals(const Mesh& mesh, NormalWeight weight)
      : mesh_(mesh),
        weight_(weight),
        unit_(unit_of(mesh.positions)),
        group_of_(mesh.shared_normals()),
        n_groups_(count_of_numbers(mesh.shared_normals(), mesh.n_vertices())) {
    make_windows();
  }

  VertexNormals run() {
    normals_.reserve(n_groups_);
    std::vector<std::size_t> windows(windows_.size());
    std::iota(windows.begin(), windows.end(), std::size_t{0});
    bool have_directions = sum_windows(windows);
    const std::vector<std::size_t> missed = add_missed_chunks();
    have_directions &= sum_windows(missed);
    VertexNormals result;
    if (group_of_.empty()) {
      result.normals = std::move(normals_);
    } else {
      result.normals.resize(mesh_.n_vertices());
      for (std::size_t v = 0; v < result.normals.size(); ++v) result.normals[v] = normals_[group_of_[v]];
    }
    if (!have_directions) result.undefined = count_undefined(result.normals);
    return result;
  }

 private:
  static constexpr std::size_t chunk_size = 2048, sample_step = 32;

  std::span<const glm::uvec3> faces_of(const Chunk& chunk) const {
    return std::span(mesh_.triangles).subspan(chunk.begin, chunk.end - chunk.begin);
  }
  std::uint32_t group(std::uint32_t v) const { return group_of_.empty() ? v : group_of_[v]; }

  /// Windows are small, so that their sums stay in a core's own cache, but not so small that many faces lie
  /// at their borders. Where neighbours are not numbered alike, so that chunks meet many windows, there is
  /// one window for each thread, and all faces are looked at beforehand.
  void make_windows() {
    constexpr std::size_t least = 16384, greatest = 32768;
    const std::size_t n_chunks = (mesh_.n_triangles() + chunk_size - 1) / chunk_size;
    chunks_.resize(n_chunks);
    std::vector<IndexRange> ranges(n_chunks);
    for (std::size_t i = 0; i < n_chunks; ++i)
      chunks_[i].begin = i * chunk_size, chunks_[i].end = std::min((i + 1) * chunk_size, mesh_.n_triangles());
    const auto find_ranges = [&](std::size_t step) {
      parallel_blocks(n_chunks, sample_step, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
          ranges[i] = range_of(chunks_[i], i % sample_step == 0 ? 1 : step);
      });
    };
    find_ranges(chunk_size / 8);
    window_size_ = std::clamp(n_groups_ / (4 * thread_count()), least, greatest);
    if (!are_neighbours_alike(ranges)) {
      window_size_ = std::max(least, (n_groups_ + thread_count() - 1) / thread_count());
      find_ranges(1);
    }
    for (std::size_t first = 0; first < n_groups_; first += window_size_)
      windows_.push_back({first, std::min(window_size_, n_groups_ - first), {}});
    for (std::size_t i = 0; i < n_chunks; ++i) {
      chunks_[i].first_window = ranges[i].first / window_size_;
      chunks_[i].last_window = ranges[i].last / window_size_;
      for (std::size_t w = chunks_[i].first_window; w <= chunks_[i].last_window; ++w)
        windows_[w].chunks.push_back(i);
    }
  }

  /// Whether chunks meet few windows, those of which all faces were looked at too: what few faces say of a
  /// chunk would be wrong of most if it were of these.
  bool are_neighbours_alike(const std::vector<IndexRange>& ranges) const {
    for (const std::size_t step : {std::size_t{1}, sample_step}) {
      std::size_t n_meetings = 0, n = 0;
      for (std::size_t i = 0; i < ranges.size(); i += step, ++n)
        n_meetings += ranges[i].last / window_size_ - ranges[i].first / window_size_ + 1;
      if (2 * n_meetings > 3 * n) return false;
    }
    return true;
  }

  /// Of the groups that every `step`th face of the chunk and its last one name.
  IndexRange range_of(const Chunk& chunk, std::size_t step) const {
    IndexRange range{std::numeric_limits<std::uint32_t>::max(), 0};
    const auto add = [&](const glm::uvec3& t) {
      const std::uint32_t a = group(t.x), b = group(t.y), c = group(t.z);
      range = {std::min({range.first, a, b, c}), std::max({range.last, a, b, c})};
    };
    for (std::size_t f = chunk.begin; f < chunk.end; f += step) add(mesh_.triangles[f]);
    add(mesh_.triangles[chunk.end - 1]);
    return range;
  }

  /// @returns false if some of the groups have no direction.
  bool sum_windows(std::span<const std::size_t> windows) {
    if (windows.empty()) return true;
    const std::size_t n_workers = std::min(thread_count(), windows.size()),
                      n_sums = std::min(window_size_, n_groups_);
    std::vector<NormalSum> sums(n_workers * n_sums);
    std::atomic<bool> have_directions{true};
    std::atomic<std::size_t> n_begun{0};
    // The sums of one thread stay in its cache from window to window.
    parallel_blocks(n_workers, 1, [&](std::size_t worker, std::size_t) {
      for (std::size_t i = n_begun++; i < windows.size(); i = n_begun++) {
        const std::size_t w = windows[i];
        if (!sum_window(w, std::span(sums).subspan(worker * n_sums, windows_[w].n))) have_directions = false;
      }
    });
    return have_directions;
  }

  /// @param sums  0 before and after.
  bool sum_window(std::size_t w, std::span<NormalSum> sums) {
    const NormalWindow window{group_of_, static_cast<std::uint32_t>(windows_[w].first), sums, unit_};
    for (const std::size_t i : windows_[w].chunks) {
      Chunk& chunk = chunks_[i];
      const IndexRange named = add_faces(mesh_.positions, faces_of(chunk), weight_, window);
      if (w == chunk.first_window) find_other_windows(chunk, named);
    }
    const std::span<glm::vec3> normals = normals_of(windows_[w]);
    std::vector<std::uint32_t> uncertain;
    const bool have_directions = unit_normals(window.sums, normals, uncertain);
    if (uncertain.empty()) return have_directions;
    return sum_again(uncertain, windows_[w], window, normals) && have_directions;
  }

  /// Where the normals of a window belong. A vector sets its elements to 0: that is done here, so that they
  /// are in the cache for what is written there next.
  std::span<glm::vec3> normals_of(const Window& window) {
    const std::lock_guard lock(growing_);
    const std::size_t end = window.first + window.n;
    if (normals_.size() < end) normals_.resize(end);
    return std::span(normals_).subspan(window.first, window.n);
  }

  /// @param named  range of the groups that the faces name.
  void find_other_windows(Chunk& chunk, const IndexRange& named) const {
    const std::size_t size = window_size_;
    if (named.first / size >= chunk.first_window && named.last / size <= chunk.last_window) return;
    std::vector<std::size_t>& others = chunk.other_windows;
    others.clear();
    for (const glm::uvec3& t : faces_of(chunk))
      for (int c = 0; c < 3; ++c) {
        const std::size_t w = group(t[c]) / size;
        if ((w < chunk.first_window || w > chunk.last_window) && (others.empty() || others.back() != w))
          others.push_back(w);
      }
    sort_and_deduplicate(others);
  }

  /// @returns windows that have got more chunks.
  std::vector<std::size_t> add_missed_chunks() {
    std::vector<std::size_t> missed;
    for (std::size_t i = 0; i < chunks_.size(); ++i)
      for (const std::size_t w : chunks_[i].other_windows) {
        windows_[w].chunks.push_back(i);
        missed.push_back(w);
      }
    sort_and_deduplicate(missed);
    for (const std::size_t w : missed) sort_and_deduplicate(windows_[w].chunks);
    return missed;
  }

  static void sort_and_deduplicate(std::vector<std::size_t>& numbers) {
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  }

  /// In double. @param uncertain  numbers of sums of the window.
  /// @returns false if some have no direction.
  bool sum_again(std::span<const std::uint32_t> uncertain, const Window& of_chunks,
                 const NormalWindow& window, std::span<glm::vec3> normals) const {
    std::vector<char> is_wanted(window.sums.size());
    for (const std::uint32_t i : uncertain) is_wanted[i] = 1;
    for (const std::size_t i : of_chunks.chunks)
      add_faces_exactly(mesh_.positions, faces_of(chunks_[i]), weight_, window, is_wanted);
    std::vector<NormalSum> sums(uncertain.size());
    for (std::size_t k = 0; k < sums.size(); ++k) std::swap(sums[k], window.sums[uncertain[k]]);
    std::vector<glm::vec3> normals_again(sums.size());
    std::vector<std::uint32_t> still_uncertain;
    const bool have_directions = unit_normals(sums, normals_again, still_uncertain);
    for (std::size_t k = 0; k < sums.size(); ++k) normals[uncertain[k]] = normals_again[k];
    return have_directions;
  }

  /// Vertices of a face that have no direction.
  std::size_t count_undefined(std::span<const glm::vec3> normals) const {
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
  std::size_t window_size_ = 0;
  std::vector<Window> windows_;
  std::mutex growing_;
  std::vector<glm::vec3> normals_;  // By group; with room for all from the beginning.
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
