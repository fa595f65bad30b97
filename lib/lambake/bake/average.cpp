#include <vector>

#include "lambake/bake/methods.h"
#include "lambake/geometry/normals.h"
#include "lambake/shading/lambert.h"

namespace lambake {

BakedColors bake_average(const Scene& scene) {
  const Mesh& mesh = scene.mesh;
  BakedColors baked;
  baked.colors = sample_at_vertices(scene, mesh, 0).colors;  // stays where no face with an area is
  const std::vector<glm::vec3> normals = face_normals(mesh);
  std::vector<glm::dvec3> sums(mesh.n_vertices(), glm::dvec3(0));
  std::vector<std::uint32_t> counts(mesh.n_vertices(), 0);
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    if (normals[f] == glm::vec3(0) || scene.materials[mesh.material_of(f)].is_unlit) continue;
    const glm::uvec3& t = mesh.triangles[f];
    const glm::vec3 centroid = (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3.0f;
    const glm::dvec3 light(irradiance<float>(scene.lights, centroid, normals[f]));
    for (int c = 0; c < 3; ++c) sums[t[c]] += light, ++counts[t[c]];
  }
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v) {
    if (counts[v] == 0) continue;
    const glm::vec3 mean(sums[v] / static_cast<double>(counts[v]));
    const LinearRgb albedo = mesh.colors.empty() ? LinearRgb{1, 1, 1} : mesh.colors[v];
    baked.colors[v] = albedo * LinearRgb{mean.r, mean.g, mean.b};
  }
  return baked;
}

}  // namespace lambake
