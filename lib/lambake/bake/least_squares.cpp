#include <fmt/format.h>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <vector>

#include "lambake/bake/methods.h"
#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/core/quadrature.h"
#include "lambake/geometry/edges.h"
#include "lambake/shading/patch.h"

// Least-squares vertex baking: Kavan, Bargteil, Sloan, Computer Graphics Forum 30(4), 2011. The colours c
// minimise
//
//   Σ_f ∫ (Σ b_i c_i − D⊗E)² dA  +  α Σ_e l² (A_1 + A_2)/3 · (jump of the derivative across e)²
//
// over the interior edges e of length l between triangles of areas A_1, A_2: scale-free. The first term gives
// the consistent mass matrix; both are the same for the three channels.
namespace lambake {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

constexpr std::size_t block_size = 256;

/// V numbers: vertices that are alike in all that lights them share one colour, so that a texture seam does
/// not show. Numbered by their first vertex.
std::vector<int> find_unknowns(const Mesh& mesh, int& n_unknowns) {
  const auto key = [&](std::uint32_t v) {
    const LinearRgb c = mesh.colors.empty() ? LinearRgb{} : mesh.colors[v];
    const glm::vec3 &p = mesh.positions[v], &n = mesh.normals[v];
    std::array<std::uint32_t, 9> bits{};
    const float values[] = {p.x, p.y, p.z, n.x, n.y, n.z, c.r, c.g, c.b};
    for (std::size_t i = 0; i < 9; ++i) bits[i] = std::bit_cast<std::uint32_t>(values[i] + 0.0f);
    return bits;
  };
  std::vector<std::uint32_t> order(mesh.n_vertices());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto ka = key(a), kb = key(b);
    return ka != kb ? ka < kb : a < b;
  });
  std::vector<std::uint32_t> first(mesh.n_vertices());
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
  std::vector<int> unknowns(mesh.n_vertices());
  n_unknowns = 0;
  for (std::uint32_t v = 0; v < unknowns.size(); ++v)
    unknowns[v] = first[v] == v ? n_unknowns++ : unknowns[first[v]];
  return unknowns;
}

Patch patch_of(const Mesh& mesh, std::size_t triangle) {
  Patch patch;
  for (int c = 0; c < 3; ++c) {
    const std::uint32_t v = mesh.triangles[triangle][c];
    patch.positions[c] = mesh.positions[v];
    patch.normals[c] = mesh.normals[v];
    if (!mesh.colors.empty()) patch.albedos[c] = {mesh.colors[v].r, mesh.colors[v].g, mesh.colors[v].b};
  }
  return patch;
}

/// ∫ b_i D⊗E dA / A over a triangle, column i for corner i: cut apart along the terminators, or quartered
/// where none crosses it.
glm::dmat3 moments(const Patch& patch, const std::vector<Light>& all) {
  constexpr std::size_t most_parts = 16;
  std::vector<std::uint32_t> lights;
  std::vector<glm::dmat3> parts{glm::dmat3(1.0)}, next;
  find_reaching_lights(all, patch, lights);
  for (const std::uint32_t i : lights) {
    next.clear();
    for (const glm::dmat3& part : parts) cut_at_terminator(all[i], patch, part, next);
    if (next.size() > most_parts) break;
    parts.swap(next);
  }
  glm::dmat3 sum(0.0);
  if (lights.empty()) return sum;
  if (parts.size() == 1) {
    const std::array<glm::dmat3, 4> four = quarters(parts[0]);
    parts.assign(four.begin(), four.end());
  }
  for (const glm::dmat3& part : parts) {
    const double share = std::abs(glm::determinant(part));
    for (const QuadratureNode& node : quadrature_5) {
      const glm::dvec3 b = part * node.b;
      const glm::dvec3 light = reference_at(patch, all, lights, false, b);
      for (int i = 0; i < 3; ++i) sum[i] += node.weight * share * b[i] * light;
    }
  }
  return sum;
}

/// ∇b_i over the triangle, column i for corner i.
glm::dmat3 gradients(const Patch& patch) {
  const glm::dmat3& p = patch.positions;
  const glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
  glm::dmat3 g;
  for (int i = 0; i < 3; ++i)
    g[i] = glm::cross(normal, p[(i + 2) % 3] - p[(i + 1) % 3]) / glm::dot(normal, normal);
  return g;
}

/// Adds the gradient-jump term of the edge between two triangles that share the unknowns of both its ends.
void add_jump(const Mesh& mesh, const std::vector<int>& unknowns, std::span<const EdgeSide> edge,
              double weight, Triplets& triplets) {
  std::array<std::pair<int, double>, 6> jump;  // ∂c/∂ν_1 + ∂c/∂ν_2, ν out of each triangle across the edge
  double areas = 0, length = 0;
  for (std::size_t s = 0; s < 2; ++s) {
    const std::uint32_t f = edge[s].corner / 3;
    const int k = static_cast<int>(edge[s].corner % 3);
    const Patch patch = patch_of(mesh, f);
    const double area = area_of(patch);
    if (!(area > 0)) return;
    areas += area;
    const glm::dmat3 g = gradients(patch);
    const glm::dvec3 out = -glm::normalize(g[(k + 2) % 3]);
    length = glm::length(patch.positions[(k + 1) % 3] - patch.positions[k]);
    for (int i = 0; i < 3; ++i)
      jump[3 * s + static_cast<std::size_t>(i)] = {unknowns[mesh.triangles[f][i]], glm::dot(g[i], out)};
  }
  const double scale = weight * length * length * areas / 3;
  for (const auto& [i, x] : jump)
    for (const auto& [j, y] : jump) triplets.emplace_back(i, j, scale * x * y);
}

}  // namespace

BakedColors bake_least_squares(const Scene& scene, const BakeOptions& options) {
  if (!(options.gradient_weight >= 0) || !std::isfinite(options.gradient_weight))
    throw InvalidOption("bake: expected a gradient weight of at least 0");
  const Mesh& mesh = scene.mesh;
  BakedColors baked;
  baked.colors = sample_at_vertices(scene, mesh, 0).colors;
  int n_unknowns = 0;
  const std::vector<int> unknowns = find_unknowns(mesh, n_unknowns);
  const auto is_lit = [&](std::size_t f) { return !scene.materials[mesh.material_of(f)].is_unlit; };

  std::vector<glm::dmat3> integrals(mesh.n_triangles());
  std::vector<double> areas(mesh.n_triangles(), 0.0);
  parallel_blocks(mesh.n_triangles(), block_size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const Patch patch = patch_of(mesh, f);
      if (!is_lit(f) || !((areas[f] = area_of(patch)) > 0)) continue;
      integrals[f] = areas[f] * moments(patch, scene.lights);
    }
  });

  Triplets triplets;
  triplets.reserve(9 * mesh.n_triangles());
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(n_unknowns, 3);
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(n_unknowns);
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    if (!(areas[f] > 0)) continue;
    for (int i = 0; i < 3; ++i) {
      const int row = unknowns[mesh.triangles[f][i]];
      mass[row] += areas[f];
      for (int c = 0; c < 3; ++c) right(row, c) += integrals[f][i][c];
      for (int j = 0; j < 3; ++j)
        triplets.emplace_back(row, unknowns[mesh.triangles[f][j]], areas[f] / (i == j ? 6 : 12));
    }
  }
  if (options.gradient_weight > 0) {
    const std::vector<EdgeSide> sides = sorted_edge_sides(mesh);
    for_each_edge(sides, [&](std::span<const EdgeSide> edge) {
      if (edge.size() != 2 || edge[0].is_forward == edge[1].is_forward) return;
      const auto unknown_at = [&](const EdgeSide& side, bool at_low) {
        const std::uint32_t k = side.corner % 3;
        return unknowns[mesh.triangles[side.corner / 3]
                                      [static_cast<int>(side.is_forward == at_low ? k : (k + 1) % 3)]];
      };
      for (const bool at_low : {true, false})
        if (unknown_at(edge[0], at_low) != unknown_at(edge[1], at_low)) return;  // a crease
      if (is_lit(edge[0].corner / 3) && is_lit(edge[1].corner / 3))
        add_jump(mesh, unknowns, edge, options.gradient_weight, triplets);
    });
  }
  // Vertices in no triangle with an area keep the sample.
  Eigen::MatrixX3d solution(n_unknowns, 3);
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v) {
    const LinearRgb& c = baked.colors[v];
    const bool is_sound = is_finite(c);
    solution.row(unknowns[v]) << (is_sound ? c.r : 0), (is_sound ? c.g : 0), (is_sound ? c.b : 0);
  }
  for (int i = 0; i < n_unknowns; ++i)
    if (!(mass[i] > 0)) {
      triplets.emplace_back(i, i, 1);
      right.row(i) = solution.row(i);
    }
  if (n_unknowns == 0) return baked;
  SparseMatrix matrix(n_unknowns, n_unknowns);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  // The mass matrix scaled by its diagonal has condition numbers below 4 on any mesh (Wathen 1987).
  Eigen::ConjugateGradient<SparseMatrix, Eigen::Lower | Eigen::Upper> solver;
  solver.setTolerance(1e-9);
  solver.setMaxIterations(2000);
  solver.compute(matrix);
  for (int c = 0; c < 3; ++c) {
    const Eigen::VectorXd start = solution.col(c);
    solution.col(c) = solver.solveWithGuess(right.col(c), start);
  }

  std::size_t n_below = 0, n_above = 0;
  std::vector<char> is_free(mesh.n_vertices(), 0);
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f)
    if (areas[f] > 0)
      for (int i = 0; i < 3; ++i) is_free[mesh.triangles[f][i]] = 1;
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v) {
    if (!is_free[v]) continue;
    const auto x = solution.row(unknowns[v]);
    const LinearRgb& sample = baked.colors[v];
    n_below += x.minCoeff() < 0;
    n_above += x.maxCoeff() > 1 && std::max({sample.r, sample.g, sample.b}) <= 1;
    baked.colors[v] = {static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])};
  }
  add_finding(baked.findings, "overshoot_below_0", n_below,
              "vert[ex is|ices are] darker than black for the least squares; no output holds that");
  add_finding(baked.findings, "overshoot_above_1", n_above,
              "vert[ex is|ices are] brighter than 1 for the least squares, but not for the light there");
  return baked;
}

}  // namespace lambake
