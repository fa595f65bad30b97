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

/// Vertices of a face that have no direction.
std::size_t count_undefined(const Mesh& mesh, std::span<const std::uint32_t> group_of,
                            std::span<const glm::vec3> normals) {
  const auto group = [&](std::uint32_t v) { return group_of.empty() ? v : group_of[v]; };
  std::vector<bool> is_used;
  for (const glm::uvec3& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t g = group(t[c]);
      if (g >= is_used.size()) is_used.resize(g + 1, false);
      is_used[g] = true;
    }
  std::size_t n = 0;
  for (std::uint32_t v = 0; v < normals.size(); ++v)
    n += normals[v] == glm::vec3(0) && group(v) < is_used.size() && is_used[group(v)];
  return n;
}

}  // namespace

VertexNormals vertex_normals(const Mesh& mesh, NormalWeight weight) {
  const std::span<const std::uint32_t> group_of =
      mesh.normal_groups.empty() ? mesh.source_vertices : mesh.normal_groups;
  std::size_t n_groups = group_of.empty() ? mesh.n_vertices() : 0;
  for (const std::uint32_t g : group_of) n_groups = std::max<std::size_t>(n_groups, g + 1);

  const auto storage = std::make_unique_for_overwrite<NormalSum[]>(n_groups);
  const std::span<NormalSum> sums(storage.get(), n_groups);
  parallel_blocks(n_groups, block_size, [&](std::size_t begin, std::size_t end) {
    std::fill_n(&sums[begin], end - begin, NormalSum{});
  });
  for (const std::vector<Chunk>& round : rounds_of_chunks(mesh, group_of))
    parallel_blocks(round.size(), 1, [&](std::size_t i, std::size_t) {
      const std::span<const glm::uvec3> triangles(mesh.triangles);
      add_faces(mesh.positions, triangles.subspan(round[i].begin, round[i].end - round[i].begin), group_of,
                weight, sums);
    });

  VertexNormals result;
  result.normals.resize(n_groups);
  std::atomic<std::size_t> n_without{0};
  parallel_blocks(n_groups, block_size, [&](std::size_t begin, std::size_t end) {
    n_without +=
        unit_normals(sums.subspan(begin, end - begin), std::span(result.normals).subspan(begin, end - begin));
  });
  if (!group_of.empty()) {
    std::vector<glm::vec3> normals(mesh.n_vertices());
    for (std::size_t v = 0; v < normals.size(); ++v) normals[v] = result.normals[group_of[v]];
    result.normals = std::move(normals);
  }
  if (n_without > 0) result.undefined = count_undefined(mesh, group_of, result.normals);
  return result;
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
