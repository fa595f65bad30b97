#include "lambake/measure/light_share.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "lambake/core/parallel.h"
#include "lambake/shading/lambert.h"

namespace lambake {
namespace {

/// Weights of the quadrature over a triangle that is exact for cubics: corners, edge middles, centroid.
constexpr double corner_weight = 1.0 / 20, middle_weight = 2.0 / 15, centroid_weight = 9.0 / 20;

struct Point {
  glm::dvec3 barycentrics;
  double weight;
};
constexpr std::array<Point, 4> inner_points = {{{{0.5, 0.5, 0}, middle_weight},
                                                {{0, 0.5, 0.5}, middle_weight},
                                                {{0.5, 0, 0.5}, middle_weight},
                                                {{1.0 / 3, 1.0 / 3, 1.0 / 3}, centroid_weight}}};

/// @param p, n  positions and normals, by corner.
LightShare share_on_triangle(const Light& light, const glm::dmat3& p, const glm::dmat3& n) {
  const glm::dvec3 at_corners(received(light, p[0], n[0]), received(light, p[1], n[1]),
                              received(light, p[2], n[2]));
  LightShare share{corner_weight * (at_corners.x + at_corners.y + at_corners.z), 0};
  for (const auto& [b, weight] : inner_points) {
    const glm::dvec3 normal = n * b;
    const double length = glm::length(normal);
    if (!(length > 0)) continue;
    const double truth = received(light, p * b, normal / length);
    share.light += weight * truth;
    share.error += weight * std::abs(truth - glm::dot(b, at_corners));
  }
  return share;
}

}  // namespace

std::vector<LightShare> light_shares(const Scene& scene) {
  const Mesh& mesh = scene.mesh;
  const std::size_t n_lights = scene.lights.size(), n_triangles = mesh.n_triangles();
  std::vector<LightShare> shares(n_lights);
  if (mesh.normals.empty()) return shares;
  constexpr std::size_t budget = 4'000'000;
  const std::size_t stride = std::max<std::size_t>(1, (n_triangles * n_lights + budget - 1) / budget);

  parallel_blocks(n_lights, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Light& light = scene.lights[i];
      const double brightness = double(light.intensity.r) + light.intensity.g + light.intensity.b;
      for (std::size_t f = 0; f < n_triangles; f += stride) {
        if (scene.materials[mesh.material_of(f)].is_unlit) continue;
        const glm::uvec3& t = mesh.triangles[f];
        glm::dmat3 p, n;
        for (int c = 0; c < 3; ++c) p[c] = mesh.positions[t[c]], n[c] = mesh.normals[t[c]];
        const double weight = brightness * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
        const LightShare share = share_on_triangle(light, p, n);
        if (!std::isfinite(weight * share.light) || !std::isfinite(weight * share.error)) continue;
        shares[i].light += weight * share.light;
        shares[i].error += weight * share.error;
      }
    }
  });

  LightShare sum;
  for (const LightShare& s : shares) sum.light += s.light, sum.error += s.error;
  for (LightShare& s : shares) {
    s.light = sum.light > 0 ? s.light / sum.light : 0;
    s.error = sum.error > 0 ? s.error / sum.error : 0;
  }
  return shares;
}

}  // namespace lambake
