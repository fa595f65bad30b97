#include "lambake/render/parent_hits.h"

#include <array>
#include <utility>

#include "lambake/core/error.h"
#include "lambake/core/parallel.h"

namespace lambake {
namespace {

constexpr std::uint32_t no_vertex = ~0U;

/// A vertex as the mean of up to three of the scene's, all corners of one triangle.
struct VertexMean {
  std::array<std::uint32_t, 3> vertices{no_vertex, no_vertex, no_vertex};
  std::array<double, 3> weights{};

  void add(std::uint32_t vertex, double weight) {
    for (std::size_t i = 0; i < 3; ++i)
      if (vertices[i] == vertex || vertices[i] == no_vertex) {
        vertices[i] = vertex;
        weights[i] += weight;
        return;
      }
    throw InvalidScene("picture: expected cuts within triangles of the scene");
  }
  void add(const VertexMean& other, double weight) {
    for (std::size_t i = 0; i < 3 && other.vertices[i] != no_vertex; ++i)
      add(other.vertices[i], weight * other.weights[i]);
  }
};

std::vector<VertexMean> means_of(const std::vector<EdgeCut>& cuts, std::size_t n_uncut) {
  std::vector<VertexMean> means(cuts.size());
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    const auto add = [&](std::uint32_t v, double weight) {
      if (v < n_uncut)
        means[i].add(v, weight);
      else
        means[i].add(means[v - n_uncut], weight);
    };
    add(cuts[i].a, 1 - double(cuts[i].t));
    add(cuts[i].b, double(cuts[i].t));
  }
  return means;
}

}  // namespace

Visibility parent_hits(const Scene& scene, const BakedColors& baked, Visibility seen) {
  if (baked.parent_triangles.empty()) return seen;  // Nothing was cut: the triangles are the scene's.
  const Mesh& mesh = mesh_of(scene, baked);
  const std::size_t n_uncut = scene.mesh.n_vertices();
  const std::vector<VertexMean> means = means_of(baked.cuts, n_uncut);
  parallel_blocks(seen.triangles.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (seen.triangles[i] == no_triangle) continue;
      const glm::uvec3& triangle = mesh.triangles[seen.triangles[i]];
      const glm::dvec2 b(seen.barycentrics[i]);
      const std::array<double, 3> weights{1 - b.x - b.y, b.x, b.y};
      VertexMean mean;
      for (int c = 0; c < 3; ++c) {
        const std::uint32_t v = triangle[c];
        const double weight = weights[static_cast<std::size_t>(c)];
        if (v < n_uncut)
          mean.add(v, weight);
        else
          mean.add(means[v - n_uncut], weight);
      }
      seen.triangles[i] = baked.parent_triangles[seen.triangles[i]];
      const glm::uvec3& parent = scene.mesh.triangles[seen.triangles[i]];
      glm::dvec3 in_parent(0);
      for (std::size_t k = 0; k < 3; ++k)
        for (int c = 0; c < 3; ++c)
          if (mean.vertices[k] == parent[c]) in_parent[c] = mean.weights[k];
      seen.barycentrics[i] = glm::vec2(in_parent.y, in_parent.z);
    }
  });
  return seen;
}

}  // namespace lambake
