#include "lambake/geometry/normals.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>

#include "lambake/core/parallel.h"
#include "lambake/geometry/normal_sums.h"

namespace lambake {
namespace {

constexpr std::size_t block_size = 4096;

glm::dvec3 area_vector(const Mesh& mesh, std::size_t f) {
  const glm::uvec3& t = mesh.triangles[f];
  return lambake::area_vector(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]);
}

/// Faces that are added one after the other; others may be added at the same time.
struct Chunk {
  std::size_t begin, end;  // Faces.
  IndexRange groups;       // That they name.
};

/// Chunks in rounds: those of one round name different groups, so that they can be added side by side, and a
/// group's faces always come in the same order. Meshes number neighbours alike, so there are few rounds; in
/// the worst case each chunk is one.
std::vector<std::vector<Chunk>> rounds_of_chunks(const Mesh& mesh, std::span<const std::uint32_t> group_of) {
  constexpr std::size_t chunk_size = 16384;
  std::vector<Chunk> chunks((mesh.n_triangles() + chunk_size - 1) / chunk_size);
  parallel_blocks(mesh.n_triangles(), chunk_size, [&](std::size_t begin, std::size_t end) {
    const std::span<const glm::uvec3> triangles(mesh.triangles);
    chunks[begin / chunk_size] = {begin, end, index_range(triangles.subspan(begin, end - begin), group_of)};
  });
  std::vector<std::vector<Chunk>> rounds;
  for (const Chunk& chunk : chunks) {
    const auto meets = [&chunk](const Chunk& other) {
      return other.groups.first <= chunk.groups.last && chunk.groups.first <= other.groups.last;
    };
    const auto found = std::find_if(rounds.begin(), rounds.end(), [&](const std::vector<Chunk>& round) {
      return std::none_of(round.begin(), round.end(), meets);
    });
    (found == rounds.end() ? rounds.emplace_back() : *found).push_back(chunk);
  }
  return rounds;
}

/// What vertex_normals() works on: the faces, and the groups of vertices that get one normal each.
class GroupNormals {
 public:
  GroupNormals(const Mesh& mesh, NormalWeight weight)
      : mesh_(mesh),
        weight_(weight),
        group_of_(mesh.normal_groups.empty() ? mesh.source_vertices : mesh.normal_groups) {
    std::size_t n_groups = group_of_.empty() ? mesh.n_vertices() : 0;
    for (const std::uint32_t g : group_of_) n_groups = std::max<std::size_t>(n_groups, g + 1);
    storage_ = std::make_unique_for_overwrite<NormalSum[]>(n_groups);
    sums_ = {storage_.get(), n_groups};
    rounds_ = rounds_of_chunks(mesh, group_of_);
  }

  VertexNormals run() {
    parallel_blocks(sums_.size(), block_size, [&](std::size_t begin, std::size_t end) {
      std::fill_n(&sums_[begin], end - begin, NormalSum{});
    });
    for_each_chunk([&](std::span<const glm::uvec3> triangles) {
      add_faces(mesh_.positions, triangles, group_of_, weight_, sums_);
    });
    VertexNormals result;
    result.normals.resize(sums_.size());
    UnitNormalCounts counts = make_units(result.normals);
    if (counts.n_uncertain > 0) {
      sum_uncertain_again();
      counts = make_units(result.normals);
    }
    if (!group_of_.empty()) {
      std::vector<glm::vec3> normals(mesh_.n_vertices());
      for (std::size_t v = 0; v < normals.size(); ++v) normals[v] = result.normals[group_of_[v]];
      result.normals = std::move(normals);
    }
    if (counts.n_without > 0) result.undefined = count_undefined(result.normals);
    return result;
  }

 private:
  template <typename Body>
  void for_each_chunk(const Body& body) {
    const std::span<const glm::uvec3> triangles(mesh_.triangles);
    for (const std::vector<Chunk>& round : rounds_)
      parallel_blocks(round.size(), 1, [&](std::size_t i, std::size_t) {
        body(triangles.subspan(round[i].begin, round[i].end - round[i].begin));
      });
  }

  UnitNormalCounts make_units(std::span<glm::vec3> normals) const {
    std::atomic<std::size_t> n_without{0}, n_uncertain{0};
    parallel_blocks(sums_.size(), block_size, [&](std::size_t begin, std::size_t end) {
      const UnitNormalCounts counts =
          unit_normals(sums_.subspan(begin, end - begin), normals.subspan(begin, end - begin));
      n_without += counts.n_without;
      n_uncertain += counts.n_uncertain;
    });
    return {n_without, n_uncertain};
  }

  void sum_uncertain_again() {
    std::vector<char> is_wanted(sums_.size());
    for (std::size_t g = 0; g < sums_.size(); ++g) {
      is_wanted[g] = is_uncertain(sums_[g]);
      if (is_wanted[g] != 0) sums_[g] = NormalSum{};
    }
    for_each_chunk([&](std::span<const glm::uvec3> triangles) {
      add_faces_exactly(mesh_.positions, triangles, group_of_, weight_, is_wanted, sums_);
    });
  }

  /// Vertices of a face that have no direction.
  std::size_t count_undefined(std::span<const glm::vec3> normals) const {
    const auto group = [&](std::uint32_t v) { return group_of_.empty() ? v : group_of_[v]; };
    std::vector<bool> is_used(sums_.size(), false);
    for (const glm::uvec3& t : mesh_.triangles)
      for (int c = 0; c < 3; ++c) is_used[group(t[c])] = true;
    std::size_t n = 0;
    for (std::uint32_t v = 0; v < normals.size(); ++v) n += normals[v] == glm::vec3(0) && is_used[group(v)];
    return n;
  }

  const Mesh& mesh_;
  NormalWeight weight_;
  std::span<const std::uint32_t> group_of_;  // By vertex, or none: each its own.
  std::unique_ptr<NormalSum[]> storage_;
  std::span<NormalSum> sums_;  // By group.
  std::vector<std::vector<Chunk>> rounds_;
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
