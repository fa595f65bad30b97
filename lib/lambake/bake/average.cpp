#include <cstdint>
#include <vector>

#include "lambake/bake/methods.h"
#include "lambake/geometry/normals.h"
#include "lambake/scene/local_frame.h"
#include "lambake/shading/lambert.h"

namespace lambake {

BakedColors bake_average(const Scene& scene) {
  const Mesh& mesh = scene.mesh;
  BakedColors baked;
  baked.colors = sample_at_vertices(scene, mesh, 0).colors;  // stays where no face with an area is
  const std::vector<glm::vec3> normals = face_normals(mesh);
  const LocalFrame local(scene);
  const std::vector<glm::vec3>& positions = local.positions();
  // Copies that share a normal share their faces too: a texture seam does not show.
  const std::vector<std::uint32_t>& groups = mesh.shared_normals();
  const std::size_t n_groups = count_of_numbers(groups, mesh.n_vertices());
  const auto group = [&](std::uint32_t v) { return groups.empty() ? v : groups[v]; };
  std::vector<glm::dvec3> sums(n_groups, glm::dvec3(0));
  std::vector<std::uint32_t> counts(n_groups, 0);
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    if (normals[f] == glm::vec3(0) || scene.materials[mesh.material_of(f)].is_unlit) continue;
    const glm::uvec3& t = mesh.triangles[f];
    const glm::vec3 centroid = (positions[t[0]] + positions[t[1]] + positions[t[2]]) / 3.0f;
    const glm::dvec3 light(irradiance<float>(local.lights(), centroid, normals[f]));
    for (int c = 0; c < 3; ++c) sums[group(t[c])] += light, ++counts[group(t[c])];
  }
  for (std::uint32_t v = 0; v < mesh.n_vertices(); ++v) {
    const std::uint32_t g = group(v);
    if (counts[g] == 0) continue;
    const glm::vec3 mean(sums[g] / static_cast<double>(counts[g]));
    const LinearRgb albedo = mesh.colors.empty() ? LinearRgb{1, 1, 1} : mesh.colors[v];
    baked.colors[v] = albedo * LinearRgb{mean.r, mean.g, mean.b};
  }
  return baked;
}

}  // namespace lambake
