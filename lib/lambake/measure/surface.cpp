#include "lambake/measure/surface.h"

#include <fmt/format.h>

#include <algorithm>

#include "lambake/core/error.h"

namespace lambake {
namespace {

glm::dvec3 to_double(const glm::vec3& v) {
  return glm::dvec3(v);
}

/// The value of vertex v: as the mesh stores it or, where it was made by a cut, exactly.
template <typename Stored>
glm::dvec3 value_at(std::uint32_t v, const std::vector<Stored>& stored, std::size_t n_uncut,
                    const std::vector<glm::dvec3>& cut) {
  return v < n_uncut ? to_double(stored[v]) : cut[v - n_uncut];
}

}  // namespace

ComparedSurface::ComparedSurface(const Scene& scene, const BakedColors& baked)
    : scene_(scene),
      mesh_(mesh_of(scene, baked)),
      colors_(baked.colors),
      hidden_emission_(baked.hidden_emission),
      parents_(baked.parent_triangles),
      finishes_(scene),
      n_uncut_(mesh_.n_vertices() - std::min(baked.cuts.size(), mesh_.n_vertices())) {
  const auto check = [](const char* what, std::size_t found, std::size_t expected) {
    if (found != expected)
      throw InvalidScene(fmt::format("measure: {}: expected {}, found {}", what, expected, found));
  };
  check_colors(scene, baked, "measure");
  check("vertex normals", mesh_.normals.size(), mesh_.n_vertices());
  if (!hidden_emission_.empty()) check("hidden emissions", hidden_emission_.size(), scene.materials.size());
  if (!baked.cuts.empty()) {
    check("vertices before the cuts", n_uncut_, scene.mesh.n_vertices());
  }
  if (!baked.cuts.empty() || !parents_.empty())
    check("parent triangles", parents_.size(), mesh_.n_triangles());

  const auto interpolate = [&](const auto& stored, std::vector<glm::dvec3>& made) {
    made.reserve(baked.cuts.size());
    for (const EdgeCut& cut : baked.cuts)
      made.push_back((1 - double(cut.t)) * value_at(cut.a, stored, n_uncut_, made) +
                     double(cut.t) * value_at(cut.b, stored, n_uncut_, made));
  };
  interpolate(mesh_.positions, cut_positions_);
  interpolate(mesh_.normals, cut_normals_);
  if (!mesh_.colors.empty()) interpolate(mesh_.colors, cut_albedos_);
}

StoredCorners ComparedSurface::stored_corners(std::size_t triangle) const {
  return lambake::stored_corners(mesh_, triangle, finishes_, scene_.mesh, n_uncut_,
                                 parents_.empty() ? triangle : parents_[triangle]);
}

Patch ComparedSurface::patch(std::size_t triangle) const {
  Patch patch;
  for (int c = 0; c < 3; ++c) {
    const std::uint32_t v = mesh_.triangles[triangle][c];
    patch.positions[c] = value_at(v, mesh_.positions, n_uncut_, cut_positions_);
    patch.normals[c] = value_at(v, mesh_.normals, n_uncut_, cut_normals_);
    if (!mesh_.colors.empty()) patch.albedos[c] = value_at(v, mesh_.colors, n_uncut_, cut_albedos_);
    patch.colors[c] = to_double(colors_[v]);
  }
  return patch;
}

}  // namespace lambake
