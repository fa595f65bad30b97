#include "lambake/render/parent_hits.h"

#include <array>
#include <vector>

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

/// The vertices that cuts made.
class CutVertices {
 public:
  CutVertices(const std::vector<EdgeCut>& cuts, std::size_t n_uncut)
      : n_uncut_(n_uncut), means_(cuts.size()) {
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      add_to(means_[i], cuts[i].a, 1 - double(cuts[i].t));
      add_to(means_[i], cuts[i].b, double(cuts[i].t));
    }
  }

  /// Adds a vertex, made by a cut or not, to a mean.
  void add_to(VertexMean& mean, std::uint32_t v, double weight) const {
    if (v < n_uncut_)
      mean.add(v, weight);
    else
      mean.add(means_[v - n_uncut_], weight);
  }

 private:
  std::size_t n_uncut_;
  std::vector<VertexMean> means_;
};

}  // namespace

Visibility parent_hits(const Scene& scene, const BakedColors& baked, Visibility seen) {
  if (baked.parent_triangles.empty()) return seen;  // Nothing was cut: the triangles are the scene's.
  const Mesh& mesh = mesh_of(scene, baked);
  const CutVertices vertices(baked.cuts, scene.mesh.n_vertices());
  parallel_blocks(seen.triangles.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (seen.triangles[i] == no_triangle) continue;
      const glm::uvec3& triangle = mesh.triangles[seen.triangles[i]];
      const glm::dvec2 b(seen.barycentrics[i]);
      const std::array<double, 3> weights{1 - b.x - b.y, b.x, b.y};
      VertexMean mean;
      for (int c = 0; c < 3; ++c) vertices.add_to(mean, triangle[c], weights[static_cast<std::size_t>(c)]);
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
