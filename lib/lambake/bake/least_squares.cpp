#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
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
//   Σ_f B_f² ∫ (Σ b_i c_i − D⊗E)² dA  +  α Σ_e min(B_1² A_1, B_2² A_2) h² (jump of the derivative across e)²
//
// over the interior edges e between triangles of areas A_1, A_2, of which h is the least height, for the
// materials' base colours B: free of scale, and however thin a triangle is, h times a derivative is at most
// what the colours of its corners differ by. The colours are at least 0, and at most 1 where the light is, as
// files hold no others. The first term gives the consistent mass matrix; both are the same for the three
// channels, which are solved one after the other: what is kept of a vertex is little more than half a row of
// the matrix, in float.
namespace lambake {
namespace {

constexpr std::uint32_t none = Unknowns::none;
constexpr std::size_t triangles_per_block = 256;
constexpr std::size_t rows_per_block = SparseMatrix::rows_per_block;
constexpr float LinearRgb::*channels[] = {&LinearRgb::r, &LinearRgb::g, &LinearRgb::b};

/// Whether normals, which are interpolated linearly, turn by more than 45 degrees in a part.
bool is_bent(const Patch& patch, const glm::dmat3& part) {
  const glm::dmat3 n = patch.normals * part;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 &a = n[i], &b = n[(i + 1) % 3];
    const double cosine = glm::dot(a, b);
    if (!(cosine > 0 && 2 * cosine * cosine >= glm::dot(a, a) * glm::dot(b, b))) return true;
  }
  return false;
}

/// Quarters bent parts, and what is left of them, a few times.
void quarter_bent_parts(const Patch& patch, std::vector<glm::dmat3>& parts) {
  constexpr int max_depth = 4;
  for (int depth = 0; depth < max_depth; ++depth) {
    const auto bent = std::partition(parts.begin(), parts.end(),
                                     [&](const glm::dmat3& part) { return !is_bent(patch, part); });
    if (bent == parts.end()) return;
    const std::vector<glm::dmat3> wholes(bent, parts.end());
    parts.erase(bent, parts.end());
    for (const glm::dmat3& whole : wholes)
      for (const glm::dmat3& quarter : quarters(whole)) parts.push_back(quarter);
  }
}

/// ∫ b_i D⊗E dA / A over a triangle, column i for corner i: cut apart along the terminators and where light
/// is narrow or normals turn.
glm::dmat3 moments(const Patch& patch, const std::vector<Light>& all) {
  std::vector<std::uint32_t> lights;
  find_reaching_lights(all, patch, lights);
  glm::dmat3 sum(0.0);
  if (lights.empty()) return sum;
  std::vector<glm::dmat3> parts = cut_at_terminators(patch, all, lights, 16);
  quarter_wide_parts(patch, all, lights, parts);
  quarter_bent_parts(patch, parts);
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

/// What colours may be.
struct Bounds {
  /// By channel and unknown, where a colour stays so: the light is at the vertex and, in the mean, around it.
  std::array<std::vector<bool>, 3> is_below_1;
  double brightest = 0;
  /// Light beyond counts as this, 1,000 times white or the median: what is brighter by many powers of ten
  /// would leave waves in the colours far around.
  double most = 0;

  /// To start from. @param sample  of a channel; not finite on a lamp.
  float guess(float sample) const {
    return std::isfinite(sample) ? std::min(sample, static_cast<float>(most)) : 0;
  }
  /// The step of a colour that counts as none: far below what a file or a screen shows.
  double resolution() const { return 1e-7 * std::min(1.0, brightest); }
};

/// By channel and unknown ∫ b_i D⊗E dA, divided by the root of the diagonal.
using RightSide = std::array<std::vector<float>, 3>;

/// Of the mean light around the unknowns, which it limits.
void set_bounds(const std::vector<double>& masses, std::array<std::vector<double>, 3>& integrals,
                Bounds& bounds) {
  const std::size_t n = masses.size();
  std::vector<float> means;
  means.reserve(n);
  for (std::size_t u = 0; u < n; ++u)
    means.push_back(static_cast<float>(
        std::min(1e30, std::max({integrals[0][u], integrals[1][u], integrals[2][u]}) / masses[u])));
  const auto middle = means.begin() + static_cast<std::ptrdiff_t>(means.size() / 2);
  if (!means.empty()) std::nth_element(means.begin(), middle, means.end());
  bounds.most = 1e3 * std::max(1.0f, means.empty() ? 0 : *middle);
  for (int c = 0; c < 3; ++c) {
    bounds.is_below_1[c].resize(n);
    for (std::size_t u = 0; u < n; ++u) {
      double& integral = integrals[c][u];
      integral = std::min(bounds.most * masses[u], integral);  // Where it is no number, the most.
      bounds.is_below_1[c][u] = integral <= masses[u];
      bounds.brightest = std::max(bounds.brightest, integral / masses[u]);
    }
  }
}

/// @param bounds  takes what the mean light around the unknowns says.
RightSide right_side(const Scene& scene, const Unknowns& unknowns, const SparseMatrix& matrix,
                     Bounds& bounds) {
  constexpr std::size_t chunk = 64 * triangles_per_block;
  std::array<std::vector<double>, 3> integrals;
  for (std::vector<double>& channel : integrals) channel.assign(unknowns.count, 0.0);
  std::vector<double> masses(unknowns.count, 0.0);
  const std::size_t n = scene.mesh.n_triangles();
  std::vector<std::pair<double, glm::dmat3>> parts(std::min(n, chunk));  // Weighted areas; see moments().
  for (std::size_t first = 0; first < n; first += chunk) {
    const std::size_t n_now = std::min(chunk, n - first);
    parallel_blocks(n_now, triangles_per_block, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        if (!unknowns.takes_part[first + k]) continue;
        const Patch patch = patch_of(scene.mesh, first + k);
        const double weight = weight_of(scene.materials[scene.mesh.material_of(first + k)]);
        parts[k] = {weight * area_of(patch) / unknowns.unit_area, moments(patch, scene.lights)};
      }
    });
    for (std::size_t k = 0; k < n_now; ++k) {
      if (!unknowns.takes_part[first + k]) continue;
      for (int i = 0; i < 3; ++i) {
        const std::uint32_t u = unknowns.of[scene.mesh.triangles[first + k][i]];
        const double share = parts[k].first / matrix.roots[u];
        masses[u] += share / 3;
        for (int c = 0; c < 3; ++c) integrals[c][u] += share * parts[k].second[i][c];
      }
    }
  }
  set_bounds(masses, integrals, bounds);
  masses = std::vector<double>();
  RightSide right;
  for (int c = 0; c < 3; ++c) {
    right[c].reserve(unknowns.count);
    for (const double integral : integrals[c]) right[c].push_back(static_cast<float>(integral));
    integrals[c] = std::vector<double>();
  }
  return right;
}

void add_samples(const Unknowns& unknowns, const std::vector<LinearRgb>& samples, Bounds& bounds) {
  for (int c = 0; c < 3; ++c)
    for (std::size_t v = 0; v < samples.size(); ++v) {
      if (unknowns.of[v] == none) continue;
      const float sample = bounds.guess(samples[v].*channels[c]);
      if (sample > 1) bounds.is_below_1[c][unknowns.of[v]] = false;
      bounds.brightest = std::max<double>(bounds.brightest, sample);
    }
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

/// Where the solver is with one channel. Colours, and steps of them, are multiplied by the roots.
struct Iterate {
  std::vector<float> x{};
  std::vector<float> residual{};   ///< Right side − A x.
  std::vector<float> direction{};  ///< Of the next step.
  SparseProduct image{};           ///< A · direction.
  std::vector<char> is_free{};     ///< The others are held at a bound.
};

/// Between what the eigenvalues of the matrix lie, on any mesh. The mass matrix, scaled by its own diagonal,
/// has such from 1/2 to 2 (Wathen 1987); the jumps, of four colours each, from 0 to 4; and they are at most
/// 72 α of the diagonal.
struct Spectrum {
  double least, greatest;
};

Spectrum spectrum_of(double gradient_weight) {
  const double most_jumps = 72 * gradient_weight;
  return {0.5 / (1 + most_jumps), (2 + 4 * most_jumps) / (1 + most_jumps)};
}

/// A step along `direction`, then Chebyshev's iteration among what is free, until no colour would move by
/// `resolution`, or of itself where it is above 1, or for as long as it takes to come nearer by nine powers
/// of ten. As nothing in it is of the whole mesh, neither a spot of light that is brighter by many powers of
/// ten nor a huge face keeps the rest from its end.
void descend(const SparseMatrix& matrix, const Spectrum& spectrum, double resolution, Iterate& at) {
  const double center = 0.5 * (spectrum.greatest + spectrum.least),
               radius = 0.5 * (spectrum.greatest - spectrum.least),
               root = std::sqrt(spectrum.greatest / spectrum.least);
  const double n_most = std::ceil(std::log(2e9) / std::log((root + 1) / (root - 1)));
  double ratio = 0;
  for (double n = 0;; ++n) {
    const double next = n > 0 ? 1 / (2 * center / radius - ratio) : radius / center;
    const auto of_direction = static_cast<float>(n > 0 ? next * ratio : 0);
    const auto of_residual = static_cast<float>(n > 0 ? 2 * next / radius : 1 / center);
    ratio = next;
    multiply(matrix, at.direction, at.image);
    const std::size_t n_far = sum_over_blocks(at.x.size(), [&](std::size_t begin, std::size_t end) {
      std::size_t n_far_here = 0;
      for (std::size_t u = begin; u < end; ++u) {
        at.x[u] += at.direction[u];
        at.residual[u] -= at.image[u];
        const float residual = at.is_free[u] ? at.residual[u] : 0.0f;
        n_far_here += std::abs(residual) > resolution * std::max(matrix.roots[u], std::abs(at.x[u]));
        at.direction[u] = of_direction * at.direction[u] + of_residual * residual;
      }
      return n_far_here;
    });
    if (n_far == 0 || n >= n_most) return;
  }
}

/// Holds at its bound what is beyond, with a step there as the new direction, and frees what the residual
/// pulls off. @returns how many of both.
std::size_t change_held(const SparseMatrix& matrix, const Bounds& bounds, int channel, Iterate& at) {
  return sum_over_blocks(at.x.size(), [&](std::size_t begin, std::size_t end) {
    std::size_t n_changed = 0;
    for (std::size_t u = begin; u < end; ++u) {
      const double root = matrix.roots[u], x = at.x[u] / root, pull = at.residual[u] / root;
      const double least_change = 100 * bounds.resolution() * std::max(1.0, std::abs(x));
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
/// Ito, Kunisch 2002). (From the samples: where it does not come to its end, it has not gone far.)
/// @param at  with the right side as residual and the samples as direction; without an image.
/// @param is_unsettled  set where a step more would move a colour by a 16-bit step or further, or by as much
///                      of itself where it is above 1.
/// @returns the colours, within the bounds.
std::vector<float> solve(const SparseMatrix& matrix, const Spectrum& spectrum, const Bounds& bounds,
                         int channel, Iterate at, std::vector<bool>& is_unsettled) {
  constexpr double settled = 1.0 / 65535;
  const std::size_t n = matrix.roots.size();
  at.x.assign(n, 0.0f);
  at.is_free.assign(n, true);
  int n_left = 50;
  do descend(matrix, spectrum, bounds.resolution(), at);
  while (change_held(matrix, bounds, channel, at) > 0 && --n_left > 0);

  for (std::size_t u = 0; u < n; ++u) {
    const float before = at.x[u] / matrix.roots[u];
    float& x = at.x[u];
    x = std::max(before, 0.0f);
    if (bounds.is_below_1[channel][u]) x = std::min(x, 1.0f);
    double step = at.residual[u] / matrix.roots[u];
    if (!at.is_free[u]) step = std::max(0.0, before < 0.5f ? step : -step);
    if (!(std::abs(step) + std::abs(x - before) < settled * std::max(1.0f, x))) is_unsettled[u] = true;
  }
  return std::move(at.x);
}

}  // namespace

BakedColors bake_least_squares(const Scene& scene, const BakeOptions& options) {
  if (!(options.gradient_weight >= 0 && options.gradient_weight <= 100))
    throw InvalidOption("bake: expected a gradient weight from 0 to 100");
  const Mesh& mesh = scene.mesh;
  if (mesh.n_triangles() > none / 3)
    throw InvalidScene(
        fmt::format("least squares: expected at most {} triangles, found {}", none / 3, mesh.n_triangles()));
  const Unknowns unknowns = find_unknowns(scene);
  const SparseMatrix matrix = least_squares_matrix(scene, unknowns, options.gradient_weight);
  Bounds bounds;
  RightSide right = right_side(scene, unknowns, matrix, bounds);
  BakedColors baked;
  baked.colors = sample_at_vertices(scene, mesh, 0).colors;
  add_samples(unknowns, baked.colors, bounds);

  // Grey light on grey surfaces is solved once.
  std::array<bool, 3> is_like_previous{};
  for (int c = 1; c < 3; ++c)
    is_like_previous[c] = right[c] == right[c - 1] &&
                          std::all_of(baked.colors.begin(), baked.colors.end(), [&](const LinearRgb& s) {
                            return s.*channels[c] == s.*channels[c - 1];
                          });
  std::vector<bool> is_unsettled(unknowns.count, false);
  for (int c = 0; c < 3; ++c) {
    if (is_like_previous[c]) {
      for (LinearRgb& color : baked.colors) color.*channels[c] = color.*channels[c - 1];
      continue;
    }
    Iterate start{.residual = std::move(right[c]), .direction = std::vector<float>(unknowns.count)};
    for (std::size_t v = 0; v < mesh.n_vertices(); ++v) {
      const std::uint32_t u = unknowns.of[v];
      if (u != none) start.direction[u] = bounds.guess(baked.colors[v].*channels[c]) * matrix.roots[u];
    }
    const std::vector<float> x =
        solve(matrix, spectrum_of(options.gradient_weight), bounds, c, std::move(start), is_unsettled);
    for (std::size_t v = 0; v < mesh.n_vertices(); ++v)
      if (unknowns.of[v] != none) baked.colors[v].*channels[c] = x[unknowns.of[v]];
  }
  add_finding(baked.findings, "least_squares_unsettled",
              static_cast<std::size_t>(std::count(is_unsettled.begin(), is_unsettled.end(), true)),
              "colour[ is|s are] not settled: with so large a gradient weight least squares does not come to "
              "its end");
  return baked;
}

}  // namespace lambake
