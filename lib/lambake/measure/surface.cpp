#include "lambake/measure/surface.h"

#include <fmt/format.h>

#include "lambake/core/error.h"

namespace lambake {

ComparedSurface::ComparedSurface(const Scene& scene, const BakedColors& baked)
    : scene_(scene),
      mesh_(mesh_of(scene, baked)),
      colors_(baked.colors),
      finishes_(scene),
      n_uncut_(mesh_.n_vertices() - std::min(baked.cuts.size(), mesh_.n_vertices())) {
  const auto check = [](const char* what, std::size_t found, std::size_t expected) {
    if (found != expected)
      throw InvalidScene(fmt::format("measure: {}: expected {}, found {}", what, expected, found));
  };
  check_colors(scene, baked, "measure");
  check("vertex normals", mesh_.normals.size(), mesh_.n_vertices());
  if (!baked.cuts.empty()) check("vertices before the cuts", n_uncut_, scene.mesh.n_vertices());

  cut_positions_.reserve(baked.cuts.size());
  cut_normals_.reserve(baked.cuts.size());
  for (const EdgeCut& cut : baked.cuts) {
    const auto value = [&](std::uint32_t v, const std::vector<glm::vec3>& uncut,
                           const std::vector<glm::dvec3>& made) {
      return v < n_uncut_ ? glm::dvec3(uncut[v]) : made[v - n_uncut_];
    };
    const double t = cut.t;
    cut_positions_.push_back((1 - t) * value(cut.a, mesh_.positions, cut_positions_) +
                             t * value(cut.b, mesh_.positions, cut_positions_));
    cut_normals_.push_back((1 - t) * value(cut.a, mesh_.normals, cut_normals_) +
                           t * value(cut.b, mesh_.normals, cut_normals_));
    if (mesh_.colors.empty()) continue;
    const auto albedo = [&](std::uint32_t v) {
      return v < n_uncut_ ? to_double(mesh_.colors[v]) : cut_albedos_[v - n_uncut_];
    };
    cut_albedos_.push_back((1 - t) * albedo(cut.a) + t * albedo(cut.b));
  }
}

Patch ComparedSurface::patch(std::size_t triangle) const {
  Patch patch;
  for (int c = 0; c < 3; ++c) {
    const std::uint32_t v = mesh_.triangles[triangle][c];
    const bool is_cut = v >= n_uncut_;
    patch.positions[c] = is_cut ? cut_positions_[v - n_uncut_] : glm::dvec3(mesh_.positions[v]);
    patch.normals[c] = is_cut ? cut_normals_[v - n_uncut_] : glm::dvec3(mesh_.normals[v]);
    if (!mesh_.colors.empty())
      patch.albedos[c] = is_cut ? cut_albedos_[v - n_uncut_] : to_double(mesh_.colors[v]);
    patch.colors[c] = to_double(colors_[v]);
  }
  return patch;
}

}  // namespace lambake
