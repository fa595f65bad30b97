#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "lambake/bake/methods.h"
#include "lambake/core/error.h"
#include "lambake/geometry/cutting.h"

namespace lambake {
namespace {

std::vector<CutMark> middles_of_edges(const CutMesh& cut) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * cut.mesh().n_triangles());
  for (const glm::uvec3& t : cut.mesh().triangles)
    for (int c = 0; c < 3; ++c) {
      const auto edge = std::minmax(cut.places()[t[c]], cut.places()[t[(c + 1) % 3]]);
      if (edge.first != edge.second) edges.emplace_back(edge);
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<CutMark> marks;
  marks.reserve(edges.size());
  for (const auto& [low, high] : edges) marks.push_back({low, high, 0.5f});
  return marks;
}

}  // namespace

BakedColors bake_uniform(const Scene& scene, const BakeOptions& options) {
  constexpr std::size_t most_triangles = std::size_t{1} << 27;  // Some 12 GB while they are made.
  if (options.levels < 0 || options.levels > 15 ||
      scene.mesh.n_triangles() > most_triangles >> (2 * options.levels))
    throw InvalidOption(fmt::format("bake: expected levels that make at most {} triangles, found {} levels",
                                    most_triangles, options.levels));
  BakedColors baked;
  {
    CutMesh cut(scene.mesh);
    for (int level = 0; level < options.levels; ++level) {
      cut.make_vertices(middles_of_edges(cut));
      cut.split([](auto...) { return false; });
      report_progress(options.progress, "cutting", (level + 1.0) / options.levels);
    }
    baked.cuts = cut.take_cuts();
    baked.parent_triangles = cut.take_parent_triangles();
    baked.mesh = cut.take_mesh();
  }
  SampledColors sampled = sample_at_vertices(scene, *baked.mesh, options.light_tolerance);
  baked.colors = std::move(sampled.colors);
  baked.light_error = sampled.light_error;
  return baked;
}

}  // namespace lambake
