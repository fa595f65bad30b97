#include "lambake/scene/mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "lambake/core/error.h"

namespace lambake {

std::uint32_t append_vertex_copy(Mesh& mesh, std::uint32_t v) {
  const auto copy = [v](auto& values) {
    if (!values.empty()) {
      const auto value = values[v];
      values.push_back(value);
    }
  };
  const auto index = static_cast<std::uint32_t>(mesh.n_vertices());
  if (mesh.source_vertices.empty()) {
    mesh.source_vertices.resize(index);
    std::iota(mesh.source_vertices.begin(), mesh.source_vertices.end(), 0U);
  }
  copy(mesh.positions);
  copy(mesh.normals);
  copy(mesh.colors);
  copy(mesh.opacities);
  for (auto& set : mesh.texcoords) copy(set);
  copy(mesh.source_vertices);
  copy(mesh.normal_groups);
  return index;
}

std::size_t count_of_numbers(const std::vector<std::uint32_t>& numbers, std::size_t n_default) {
  return numbers.empty() ? n_default : *std::max_element(numbers.begin(), numbers.end()) + std::size_t{1};
}

std::vector<glm::vec3> positions_in_faces(const Mesh& mesh) {
  std::vector<bool> is_used(mesh.n_vertices(), false);
  for (const glm::uvec3& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) is_used[t[c]] = true;
  std::vector<glm::vec3> positions;
  positions.reserve(mesh.n_vertices());
  for (std::size_t v = 0; v < is_used.size(); ++v)
    if (is_used[v]) positions.push_back(mesh.positions[v]);
  return positions;
}

std::vector<std::uint32_t> vertex_materials(const Mesh& mesh) {
  std::vector<std::uint32_t> materials(mesh.n_vertices(), 0);
  if (mesh.materials.empty()) return materials;
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f)
    for (int c = 0; c < 3; ++c) materials[mesh.triangles[f][c]] = mesh.materials[f];
  return materials;
}

std::vector<bool> used_materials(const Mesh& mesh, std::size_t n_materials) {
  std::vector<bool> is_used(n_materials, false);
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) is_used[mesh.material_of(f)] = true;
  return is_used;
}

double Mesh::cut_rounding_of(std::size_t triangle) const {
  const auto found =
      std::upper_bound(cut_roundings.begin(), cut_roundings.end(), triangle,
                       [](std::size_t t, const CutRounding& rounding) { return t < rounding.triangle_end; });
  return found == cut_roundings.end() ? 0 : found->distance;
}

void check_mesh(const Mesh& mesh, std::size_t n_materials) {
  const std::size_t n_vertices = mesh.n_vertices();
  const std::size_t n_triangles = mesh.n_triangles();
  constexpr std::size_t most_vertices = std::size_t{1} << 31, most_triangles = (std::size_t{1} << 32) / 3;
  if (n_vertices > most_vertices || n_triangles > most_triangles)
    throw InvalidScene(fmt::format("mesh: expected at most {} vertices and {} triangles, found {} and {}",
                                   most_vertices, most_triangles, n_vertices, n_triangles));
  const auto check_length = [](const char* name, std::size_t found, std::size_t expected) {
    if (found != 0 && found != expected)
      throw InvalidScene(fmt::format("mesh: {}: expected {} or no values, found {}", name, expected, found));
  };
  check_length("normals", mesh.normals.size(), n_vertices);
  check_length("colors", mesh.colors.size(), n_vertices);
  check_length("opacities", mesh.opacities.size(), n_vertices);
  check_length("texcoords[0]", mesh.texcoords[0].size(), n_vertices);
  check_length("texcoords[1]", mesh.texcoords[1].size(), n_vertices);
  check_length("source_vertices", mesh.source_vertices.size(), n_vertices);
  check_length("normal_groups", mesh.normal_groups.size(), n_vertices);
  check_length("materials", mesh.materials.size(), n_triangles);
  check_length("source_faces", mesh.source_faces.size(), n_triangles);
  std::size_t end = 0;
  for (const CutRounding& rounding : mesh.cut_roundings) {
    if (rounding.triangle_end <= end || rounding.triangle_end > n_triangles || !(rounding.distance >= 0))
      throw InvalidScene(
          fmt::format("mesh: cut_roundings: expected an end above {} and at most {} and a distance of at "
                      "least 0, found {} and {}",
                      end, n_triangles, rounding.triangle_end, rounding.distance));
    end = rounding.triangle_end;
  }
  if (!mesh.cut_roundings.empty() && end != n_triangles)
    throw InvalidScene(
        fmt::format("mesh: cut_roundings: expected the last to end at {}, found {}", n_triangles, end));
  for (std::size_t f = 0; f < n_triangles; ++f) {
    const glm::uvec3& t = mesh.triangles[f];
    for (int corner = 0; corner < 3; ++corner)
      if (t[corner] >= n_vertices)
        throw InvalidScene(
            fmt::format("mesh: triangle {}: expected indices below {}, found {}", f, n_vertices, t[corner]));
    if (mesh.material_of(f) >= n_materials)
      throw InvalidScene(fmt::format("mesh: triangle {}: expected a material below {}, found {}", f,
                                     n_materials, mesh.material_of(f)));
  }
}

}  // namespace lambake
