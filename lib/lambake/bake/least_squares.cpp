#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "lambake/bake/least_squares_matrix.h"
#include "lambake/bake/methods.h"
#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/core/quadrature.h"
#include "lambake/shading/patch.h"
#include "lambake/shading/patch_parts.h"

// Least-squares vertex baking: Kavan, Bargteil, Sloan, Computer Graphics Forum 30(4), 2011. The colours c
// minimise
//
//   Σ_f ∫ (Σ b_i c_i − D⊗E)² dA  +  α Σ_e min(A_1, A_2) h² (jump of the derivative across e)²
//
// over the interior edges e between triangles of areas A_1, A_2, of which h is the least height: free of
// scale, and however thin a triangle is, h times a derivative is at most what the colours of its corners
// differ by. The colours are at least 0, and at most 1 where the light is, as files hold no others. The first
// term gives the consistent mass matrix; both are the same for the three channels, which are solved one after
// the other: what is kept of a vertex is little more than half a row of the matrix, in float.
namespace lambake {
namespace {

constexpr std::uint32_t none = Unknowns::none;
constexpr std::size_t triangles_per_block = 256;
constexpr std::size_t rows_per_block = SparseMatrix::rows_per_block;
constexpr float LinearRgb::*channels[] = {&LinearRgb::r, &LinearRgb::g, &LinearRgb::b};

/// ∫ b_i D⊗E dA / A over a triangle, column i for corner i: cut apart along the terminators and where light
/// is narrow.
glm::dmat3 moments(const Patch& patch, const std::vector<Light>& all) {
  std::vector<std::uint32_t> lights;
  find_reaching_lights(all, patch, lights);
  glm::dmat3 sum(0.0);
  if (lights.empty()) return sum;
  std::vector<glm::dmat3> parts = cut_at_terminators(patch, all, lights, 16);
  quarter_wide_parts(patch, all, lights, parts);
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

/// By unknown, divided by the root of its diagonal.
struct RightSide {
  std::array<std::vector<float>, 3> integrals;  ///< ∫ b_i D⊗E dA, by channel.
  std::vector<float> masses;                    ///< ∫ b_i dA.
};

RightSide right_side(const Scene& scene, const Unknowns& unknowns, const SparseMatrix& matrix) {
  constexpr std::size_t chunk = 64 * triangles_per_block;
  RightSide right;
  for (std::vector<float>& channel : right.integrals) channel.assign(unknowns.count, 0.0f);
  right.masses.assign(unknowns.count, 0.0f);
  const std::size_t n = scene.mesh.n_triangles();
  std::vector<std::pair<double, glm::dmat3>> parts(std::min(n, chunk));  // Areas; see moments().
  for (std::size_t first = 0; first < n; first += chunk) {
    const std::size_t n_now = std::min(chunk, n - first);
    parallel_blocks(n_now, triangles_per_block, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        if (!unknowns.takes_part[first + k]) continue;
        const Patch patch = patch_of(scene.mesh, first + k);
        parts[k] = {area_of(patch) / unknowns.largest_area, moments(patch, scene.lights)};
      }
    });
    for (std::size_t k = 0; k < n_now; ++k) {
      if (!unknowns.takes_part[first + k]) continue;
      for (int i = 0; i < 3; ++i) {
        const std::uint32_t u = unknowns.of[scene.mesh.triangles[first + k][i]];
        const double share = parts[k].first / matrix.roots[u];
        right.masses[u] += static_cast<float>(share / 3);
        for (int c = 0; c < 3; ++c)
          right.integrals[c][u] += static_cast<float>(share * parts[k].second[i][c]);
      }
    }
  }
  return right;
}

/// The sum of body(begin, end) over the blocks of n rows, in their order.
template <typename Body>
auto sum_over_blocks(std::size_t n, const Body& body) {
  std::vector<decltype(body(n, n))> sums((n + rows_per_block - 1) / rows_per_block);
  parallel_blocks(n, rows_per_block, [&](std::size_t begin, std::size_t end) {
    sums[begin / rows_per_block] = body(begin, end);
  });
  return std::accumulate(sums.begin(), sums.end(), decltype(body(n, n))(0.0));
}

float finite_or_0(float value) {
  return std::isfinite(value) ? value : 0;
}

/// What colours may be.
struct Bounds {
  /// By channel and unknown, where a colour stays so: the light is at the vertex and, in the mean, around it.
  std::array<std::vector<bool>, 3> is_below_1;
  /// The step of a colour that counts as none: far below what a file or a screen shows, and what double holds
  /// of the brightest.
  double resolution = 0;
};

Bounds bounds_of(const Unknowns& unknowns, const std::vector<LinearRgb>& samples, const RightSide& right) {
  Bounds bounds;
  double brightest = 0;
  for (int c = 0; c < 3; ++c) {
    bounds.is_below_1[c].resize(unknowns.count);
    for (std::size_t v = 0; v < samples.size(); ++v) {
      const std::uint32_t u = unknowns.of[v];
      if (u == none) continue;
      const double mean = double(right.integrals[c][u]) / right.masses[u];
      const double light = std::max<double>(finite_or_0(samples[v].*channels[c]), mean);
      bounds.is_below_1[c][u] = light <= 1;
      if (std::isfinite(light)) brightest = std::max(brightest, light);
    }
  }
  bounds.resolution = std::max(1e-7 * std::min(1.0, brightest), 1e-14 * brightest);
  return bounds;
}

/// Where the solver is with one channel. Colours, and steps of them, are multiplied by the roots.
struct Iterate {
  std::vector<float> x{};
  std::vector<float> residual{};   ///< Right side − A x.
  std::vector<float> direction{};  ///< Of the next step.
  SparseProduct image{};           ///< A · direction.
  std::vector<char> is_free{};     ///< The others are held at a bound.
};

/// Of the free residual: the sum of squares, and the largest step of a colour.
struct Distance {
  double square = 0, largest = 0;

  explicit Distance(double = 0) {}
  friend Distance operator+(Distance a, const Distance& b) {
    a.square += b.square;
    a.largest = std::max(a.largest, b.largest);
    return a;
  }
};

/// A step along `direction`, then conjugate gradients among what is free, until no colour is a step of
/// `resolution` away. A large face elsewhere must not hide what small ones lack.
/// @param n_left  of iterations: counted down.
void descend(const SparseMatrix& matrix, double resolution, int& n_left, Iterate& at) {
  const std::size_t n = at.x.size();
  const auto free_residual = [&](std::size_t u) { return at.is_free[u] ? at.residual[u] : 0.0f; };
  multiply(matrix, at.direction, at.image);
  double step = 1, old_square = 0;
  for (;;) {
    const Distance left = sum_over_blocks(n, [&](std::size_t begin, std::size_t end) {
      Distance sum;
      const auto along = static_cast<float>(step);
      for (std::size_t u = begin; u < end; ++u) {
        at.x[u] += along * at.direction[u];
        at.residual[u] -= along * at.image[u];
        const double r = free_residual(u);
        sum.square += r * r;
        sum.largest = std::max(sum.largest, std::abs(r) / matrix.roots[u]);
      }
      return sum;
    });
    if (!(left.largest > resolution) || --n_left <= 0) return;
    const auto turn = static_cast<float>(old_square > 0 ? left.square / old_square : 0);
    old_square = left.square;
    parallel_blocks(n, rows_per_block, [&](std::size_t begin, std::size_t end) {
      for (std::size_t u = begin; u < end; ++u) at.direction[u] = free_residual(u) + turn * at.direction[u];
    });
    multiply(matrix, at.direction, at.image);
    const double curvature = sum_over_blocks(n, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t u = begin; u < end; ++u) sum += double(at.direction[u]) * at.image[u];
      return sum;
    });
    step = curvature > 0 ? old_square / curvature : 0;
  }
}

/// Holds at its bound what is beyond, with a step there as the new direction, and frees what the residual
/// pulls off. @returns how many of both.
std::size_t change_held(const SparseMatrix& matrix, const Bounds& bounds, int channel, Iterate& at) {
  const double least_change = 100 * bounds.resolution;
  return sum_over_blocks(at.x.size(), [&](std::size_t begin, std::size_t end) {
    std::size_t n_changed = 0;
    for (std::size_t u = begin; u < end; ++u) {
      const double root = matrix.roots[u], x = at.x[u] / root, pull = at.residual[u] / root;
      const bool is_low = x < -least_change, is_high = bounds.is_below_1[channel][u] && x > 1 + least_change;
      const bool was_free = at.is_free[u];
      const bool is_free = was_free ? !is_low && !is_high : (x < 0.5 ? pull : -pull) > least_change;
      at.direction[u] = was_free && !is_free ? static_cast<float>(((is_high ? 1 : 0) - x) * root) : 0.0f;
      at.is_free[u] = is_free;
      n_changed += is_free != was_free;
    }
    return n_changed;
  });
}

/// Least squares with 0 <= x, and x <= 1 where the bounds say so, by a primal-dual active set (Hintermüller,
/// Ito, Kunisch 2002). Scaled by its diagonal the matrix has eigenvalues between 1 / (2 + 144 α) and 4 on any
/// mesh: the mass matrix, scaled by its own, from 1/2 to 2 (Wathen 1987), to which the jumps, of four colours
/// each, add at most 72 α. So it takes few iterations, unless α is large. (From the samples: where it does
/// not come to its end, it has not gone far.)
/// @param at  with the right side as residual and the samples as direction; without an image.
/// @param is_unsettled  set where a step more would move a colour by a 16-bit step or further.
/// @returns the colours, within the bounds.
std::vector<float> solve(const SparseMatrix& matrix, const Bounds& bounds, int channel, Iterate at,
                         std::vector<bool>& is_unsettled) {
  constexpr double settled = 1.0 / 65535;
  const std::size_t n = matrix.roots.size();
  at.x.assign(n, 0.0f);
  at.is_free.assign(n, true);
  int n_left = 2000;
  do descend(matrix, bounds.resolution, n_left, at);
  while (change_held(matrix, bounds, channel, at) > 0 && n_left > 0);

  for (std::size_t u = 0; u < n; ++u) {
    const float before = at.x[u] / matrix.roots[u];
    float& x = at.x[u];
    x = std::max(before, 0.0f);
    if (bounds.is_below_1[channel][u]) x = std::min(x, 1.0f);
    const double step = at.is_free[u] ? at.residual[u] / matrix.roots[u] : 0;
    if (!(std::abs(step) + std::abs(x - before) < settled)) is_unsettled[u] = true;
  }
  return std::move(at.x);
}

}  // namespace

BakedColors bake_least_squares(const Scene& scene, const BakeOptions& options) {
  if (!(options.gradient_weight >= 0) || !std::isfinite(options.gradient_weight))
    throw InvalidOption("bake: expected a gradient weight of at least 0");
  const Mesh& mesh = scene.mesh;
  if (mesh.n_triangles() > none / 3)
    throw InvalidScene(
        fmt::format("least squares: expected at most {} triangles, found {}", none / 3, mesh.n_triangles()));
  BakedColors baked;
  baked.colors = sample_at_vertices(scene, mesh, 0).colors;
  const Unknowns unknowns = find_unknowns(scene);
  const SparseMatrix matrix = least_squares_matrix(mesh, unknowns, options.gradient_weight);
  RightSide right = right_side(scene, unknowns, matrix);
  const Bounds bounds = bounds_of(unknowns, baked.colors, right);
  right.masses = {};

  // Grey light on grey surfaces is solved once.
  std::array<bool, 3> is_like_previous{};
  for (int c = 1; c < 3; ++c)
    is_like_previous[c] = right.integrals[c] == right.integrals[c - 1] &&
                          std::all_of(baked.colors.begin(), baked.colors.end(), [&](const LinearRgb& s) {
                            return s.*channels[c] == s.*channels[c - 1];
                          });
  std::vector<bool> is_unsettled(unknowns.count, false);
  for (int c = 0; c < 3; ++c) {
    if (is_like_previous[c]) {
      for (LinearRgb& color : baked.colors) color.*channels[c] = color.*channels[c - 1];
      continue;
    }
    Iterate start{.residual = std::move(right.integrals[c]), .direction = std::vector<float>(unknowns.count)};
    for (std::size_t v = 0; v < mesh.n_vertices(); ++v) {
      const std::uint32_t u = unknowns.of[v];
      if (u != none) start.direction[u] = finite_or_0(baked.colors[v].*channels[c]) * matrix.roots[u];
    }
    const std::vector<float> x = solve(matrix, bounds, c, std::move(start), is_unsettled);
    for (std::size_t v = 0; v < mesh.n_vertices(); ++v)
      if (unknowns.of[v] != none) baked.colors[v].*channels[c] = x[unknowns.of[v]];
  }
  add_finding(
      baked.findings, "least_squares_unsettled",
      static_cast<std::size_t>(std::count(is_unsettled.begin(), is_unsettled.end(), true)),
      "colour[ is|s are] not settled: with so large a gradient weight slivers keep least squares from "
      "its end; other methods do not mind them");
  return baked;
}

}  // namespace lambake
