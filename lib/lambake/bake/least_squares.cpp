#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "lambake/bake/methods.h"
#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/core/quadrature.h"
#include "lambake/core/value_numbers.h"
#include "lambake/geometry/edges.h"
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
// term gives the consistent mass matrix; both are the same for the three channels.
namespace lambake {
namespace {

constexpr std::size_t block_size = 256;       // triangles
constexpr std::size_t rows_per_block = 1024;  // unknowns

/// Vertices that are alike in all that lights them share one colour, so that a texture seam does not show.
struct Unknowns {
  std::vector<std::uint32_t> of;  ///< V; numbered by their first vertex.
  std::uint32_t count = 0;
};

Unknowns find_unknowns(const Mesh& mesh) {
  ValueNumbers<9> numbers;
  Unknowns unknowns;
  unknowns.of.reserve(mesh.n_vertices());
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v) {
    const glm::vec3 p = mesh.positions[v] + 0.0f, n = mesh.normals[v] + 0.0f;
    const LinearRgb c = mesh.colors.empty() ? LinearRgb{} : mesh.colors[v];
    unknowns.of.push_back(
        numbers.number_of({p.x, p.y, p.z, n.x, n.y, n.z, c.r + 0.0f, c.g + 0.0f, c.b + 0.0f}));
  }
  unknowns.count = static_cast<std::uint32_t>(numbers.size());
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

/// ∫ b_i D⊗E dA / A over a triangle, column i for corner i: cut apart along the terminators and where light
/// is narrow, or quartered where there is neither.
glm::dmat3 moments(const Patch& patch, const std::vector<Light>& all) {
  std::vector<std::uint32_t> lights;
  find_reaching_lights(all, patch, lights);
  glm::dmat3 sum(0.0);
  if (lights.empty()) return sum;
  std::vector<glm::dmat3> parts = cut_at_terminators(patch, all, lights, 16);
  quarter_wide_parts(patch, all, lights, parts);
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

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// A triangle as the matrix sees it.
struct Element {
  double area = 0;  ///< 0 if it takes no part: it is unlit or has none.
  glm::dvec3 cotangents{0.0};
  glm::uvec3 unknowns{0};
  glm::uvec3 beyond{none};  ///< For its side from corner c to the next the same of its neighbour, or none.
};

/// F, without `beyond`.
std::vector<Element> elements_of(const Scene& scene, const Unknowns& unknowns) {
  const Mesh& mesh = scene.mesh;
  std::vector<Element> elements(mesh.n_triangles());
  parallel_blocks(elements.size(), block_size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      if (scene.materials[mesh.material_of(f)].is_unlit) continue;
      const Patch patch = patch_of(mesh, f);
      const glm::dmat3& p = patch.positions;
      Element& element = elements[f];
      element.area = area_of(patch);
      if (!(element.area > 0)) continue;
      for (int i = 0; i < 3; ++i) {
        element.unknowns[i] = unknowns.of[mesh.triangles[f][i]];
        element.cotangents[i] = glm::dot(p[(i + 1) % 3] - p[i], p[(i + 2) % 3] - p[i]) / (2 * element.area);
      }
    }
  });
  return elements;
}

/// l ∂b_i/∂ν for the corners i, with ν out of the triangle across its side k of length l.
glm::dvec3 slopes_across(const Element& element, int k) {
  const int next = (k + 1) % 3;
  glm::dvec3 slopes;
  slopes[k] = element.cotangents[next];
  slopes[next] = element.cotangents[k];
  slopes[(k + 2) % 3] = -(element.cotangents[k] + element.cotangents[next]);
  return slopes;
}

/// (h/l)² for the least height h of the triangle and the length l of its side k.
double height_over_side(const Element& element, int k) {
  const glm::dvec3& c = element.cotangents;
  // Squared lengths over twice the area, of the longest side and of this one.
  const double longest = c.x + c.y + c.z - std::min({c.x, c.y, c.z}), side = c[k] + c[(k + 1) % 3];
  return 1 / std::max(1.0, longest * side);
}

/// Sets `beyond`: neighbours take part both, wind alike and share the unknowns of both ends.
void find_neighbours(const Mesh& mesh, std::vector<Element>& elements) {
  const std::vector<EdgeSide> sides = sorted_edge_sides(mesh);
  for_each_edge(sides, [&](std::span<const EdgeSide> edge) {
    if (edge.size() != 2 || edge[0].is_forward == edge[1].is_forward) return;
    Element &f = elements[edge[0].corner / 3], &g = elements[edge[1].corner / 3];
    if (!(f.area > 0 && g.area > 0)) return;
    const int k = static_cast<int>(edge[0].corner % 3), m = static_cast<int>(edge[1].corner % 3);
    if (f.unknowns[k] != g.unknowns[(m + 1) % 3] || f.unknowns[(k + 1) % 3] != g.unknowns[m])
      return;  // a crease
    f.beyond[k] = edge[1].corner;
    g.beyond[m] = edge[0].corner;
  });
}

/// The corners (3·triangle + c) of the triangles that take part, in the order of the triangles.
struct Corners {
  std::vector<std::uint32_t> starts;  ///< Those of unknown u are `numbers` from starts[u] to starts[u + 1].
  std::vector<std::uint32_t> numbers;
  std::span<const std::uint32_t> of(std::size_t u) const {
    return std::span(numbers).subspan(starts[u], starts[u + 1] - starts[u]);
  }
};

Corners corners_by_unknown(const std::vector<Element>& elements, std::size_t n_unknowns) {
  const auto for_each_corner = [&](auto&& visit) {
    for (std::size_t f = 0; f < elements.size(); ++f)
      if (elements[f].area > 0)
        for (int c = 0; c < 3; ++c)
          visit(elements[f].unknowns[c], static_cast<std::uint32_t>(3 * f) + static_cast<std::uint32_t>(c));
  };
  Corners corners;
  corners.starts.assign(n_unknowns + 2, 0);  // Of u at u + 1, which filling moves to the start of u + 1.
  for_each_corner([&](std::uint32_t u, std::uint32_t) { ++corners.starts[u + 2]; });
  std::partial_sum(corners.starts.begin(), corners.starts.end(), corners.starts.begin());
  corners.numbers.resize(corners.starts.back());
  for_each_corner(
      [&](std::uint32_t u, std::uint32_t number) { corners.numbers[corners.starts[u + 1]++] = number; });
  return corners;
}

/// The right side: ∫ b_i D⊗E dA for each unknown, channel by channel.
std::vector<glm::dvec3> right_side(const Scene& scene, const std::vector<Element>& elements,
                                   const Corners& corners, std::size_t n_unknowns) {
  std::vector<glm::dmat3> integrals(elements.size());
  parallel_blocks(elements.size(), block_size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      if (elements[f].area > 0)
        integrals[f] = elements[f].area * moments(patch_of(scene.mesh, f), scene.lights);
  });
  std::vector<glm::dvec3> right(n_unknowns, glm::dvec3(0));
  parallel_blocks(n_unknowns, rows_per_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t u = begin; u < end; ++u)
      for (const std::uint32_t corner : corners.of(u))
        right[u] += integrals[corner / 3][static_cast<int>(corner % 3)];
  });
  return right;
}

/// A block of consecutive rows of the sparse matrix.
struct Rows {
  std::vector<std::size_t> ends;       ///< Of each row, in `columns` and `values`.
  std::vector<std::uint32_t> columns;  ///< Ascending in each row.
  std::vector<double> values;

  glm::dvec3 product(std::size_t row, const std::vector<glm::dvec3>& x) const {
    glm::dvec3 sum(0);
    for (std::size_t e = row > 0 ? ends[row - 1] : 0; e < ends[row]; ++e) sum += values[e] * x[columns[e]];
    return sum;
  }
  double sum(std::size_t row) const {
    const auto at = [&](std::size_t end) { return values.begin() + static_cast<std::ptrdiff_t>(end); };
    return std::accumulate(at(row > 0 ? ends[row - 1] : 0), at(ends[row]), 0.0);
  }
};

struct Matrix {
  std::vector<Rows> blocks;      ///< Of `rows_per_block`, the last one of fewer.
  std::vector<double> diagonal;  ///< Once more.
};

using Entries = std::vector<std::pair<std::uint32_t, double>>;  // columns and values

/// Adds what one triangle gives to the row of the unknown at its corner `corner` (3·triangle + c).
void add_to_row(const std::vector<Element>& elements, std::uint32_t corner, double gradient_weight,
                Entries& row) {
  const Element& f = elements[corner / 3];
  const int i = static_cast<int>(corner % 3);
  glm::dvec3 values(f.area / 12);
  values[i] *= 2;
  for (int k = 0; k < 3; ++k) {
    if (f.beyond[k] == none) continue;
    // l times the jump is s + t over the corners of both. Of a row of an end of the side this is what s_i
    // gives; what t gives comes from g.
    const Element& g = elements[f.beyond[k] / 3];
    const int m = static_cast<int>(f.beyond[k] % 3);
    const glm::dvec3 s = slopes_across(f, k), t = slopes_across(g, m);
    const double scale = gradient_weight * std::min(f.area, g.area) *
                         std::min(height_over_side(f, k), height_over_side(g, m)) * s[i];
    values += scale * s;
    values[k] += scale * t[(m + 1) % 3];
    values[(k + 1) % 3] += scale * t[m];
    row.emplace_back(g.unknowns[(m + 2) % 3], scale * t[(m + 2) % 3]);
  }
  for (int j = 0; j < 3; ++j) row.emplace_back(f.unknowns[j], values[j]);
}

/// Each row gathers from the triangles around its unknown; where there is none it is one of the identity.
Matrix assemble(const std::vector<Element>& elements, const Corners& corners, std::size_t n_unknowns,
                double gradient_weight) {
  Matrix matrix{.blocks = std::vector<Rows>((n_unknowns + rows_per_block - 1) / rows_per_block),
                .diagonal = std::vector<double>(n_unknowns)};
  parallel_blocks(n_unknowns, rows_per_block, [&](std::size_t begin, std::size_t end) {
    Rows rows;
    Entries row;
    for (std::size_t u = begin; u < end; ++u) {
      row.clear();
      for (const std::uint32_t corner : corners.of(u)) add_to_row(elements, corner, gradient_weight, row);
      if (row.empty()) row.emplace_back(u, 1.0);
      std::stable_sort(row.begin(), row.end(),
                       [](const auto& a, const auto& b) { return a.first < b.first; });
      for (std::size_t e = 0; e < row.size();) {
        const std::uint32_t column = row[e].first;
        double value = 0;
        for (; e < row.size() && row[e].first == column; ++e) value += row[e].second;
        rows.columns.push_back(column);
        rows.values.push_back(value);
        if (column == u) matrix.diagonal[u] = value;
      }
      rows.ends.push_back(rows.columns.size());
    }
    rows.columns.shrink_to_fit();
    rows.values.shrink_to_fit();
    matrix.blocks[begin / rows_per_block] = std::move(rows);
  });
  return matrix;
}

/// The normal equations.
struct System {
  Matrix matrix;
  std::vector<glm::dvec3> right;
  std::vector<char> is_free;  ///< V: whether the vertex is in a triangle that takes part.
};

System system_of(const Scene& scene, const Unknowns& unknowns, double gradient_weight) {
  const Mesh& mesh = scene.mesh;
  std::vector<Element> elements = elements_of(scene, unknowns);
  const Corners corners = corners_by_unknown(elements, unknowns.count);
  System system;
  system.right = right_side(scene, elements, corners, unknowns.count);
  if (gradient_weight > 0) find_neighbours(mesh, elements);
  system.matrix = assemble(elements, corners, unknowns.count, gradient_weight);
  system.is_free.assign(mesh.n_vertices(), 0);
  for (std::size_t f = 0; f < elements.size(); ++f)
    if (elements[f].area > 0)
      for (int i = 0; i < 3; ++i) system.is_free[mesh.triangles[f][i]] = 1;
  return system;
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

/// What the solver starts from.
struct Guess {
  std::vector<glm::dvec3> x{};           ///< The samples, by unknown.
  std::vector<glm::bvec3> is_below_1{};  ///< Channels that stay so: the light is at the vertex and, in the
                                         ///< mean, around it.
  /// The step of a colour that counts as none: far below what a file or a screen shows, and what double holds
  /// of the brightest.
  double resolution = 0;
};

void set_bounds(const System& system, Guess& guess) {
  double brightest = 0;
  guess.is_below_1.resize(guess.x.size());
  for (std::size_t u = 0; u < guess.x.size(); ++u) {
    const double mass = system.matrix.blocks[u / rows_per_block].sum(u % rows_per_block);
    const glm::dvec3 light = glm::max(guess.x[u], system.right[u] / mass);
    guess.is_below_1[u] = glm::lessThanEqual(light, glm::dvec3(1));
    for (int c = 0; c < 3; ++c)
      if (std::isfinite(light[c])) brightest = std::max(brightest, light[c]);
  }
  guess.resolution = std::max(1e-8 * std::min(1.0, brightest), 1e-14 * brightest);
}

/// Where the solver is, for the three channels side by side.
struct Iterate {
  std::vector<glm::dvec3> x;
  std::vector<glm::dvec3> residual;   ///< Right side - A x.
  std::vector<glm::dvec3> direction;  ///< Of the next step.
  std::vector<glm::dvec3> image;      ///< A · direction.
  std::vector<glm::bvec3> is_free;    ///< The others are held at a bound.
};

/// Of the free residual r and the diagonal d: Σ r²/d, and the largest |r|/d, a step of a colour.
struct Distance {
  glm::dvec3 square{0.0}, largest{0.0};

  explicit Distance(double = 0) {}
  friend Distance operator+(Distance a, const Distance& b) {
    a.square += b.square;
    a.largest = glm::max(a.largest, b.largest);
    return a;
  }
};

/// A step along `direction`, then conjugate gradients with the diagonal as preconditioner among what is free,
/// until no colour is a step of `resolution` away. A large face elsewhere must not hide what small ones lack.
/// @param n_left  of iterations: counted down.
void descend(const Matrix& matrix, double resolution, int& n_left, Iterate& at) {
  const std::size_t n = at.x.size();
  const auto ratio = [](const glm::dvec3& a, const glm::dvec3& b) {
    glm::dvec3 r(0);  // where nothing is left to do
    for (int c = 0; c < 3; ++c)
      if (b[c] > 0) r[c] = a[c] / b[c];
    return r;
  };
  const auto set_image = [&](std::size_t u) -> const glm::dvec3& {
    return at.image[u] = matrix.blocks[u / rows_per_block].product(u % rows_per_block, at.direction);
  };
  const auto free_residual = [&](std::size_t u) { return at.residual[u] * glm::dvec3(at.is_free[u]); };
  parallel_blocks(n, rows_per_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t u = begin; u < end; ++u) set_image(u);
  });
  glm::dvec3 step(1), old_rz(0);
  for (;;) {
    const Distance left = sum_over_blocks(n, [&](std::size_t begin, std::size_t end) {
      Distance sum;
      for (std::size_t u = begin; u < end; ++u) {
        at.x[u] += step * at.direction[u];
        at.residual[u] -= step * at.image[u];
        const glm::dvec3 r = free_residual(u), change = r / matrix.diagonal[u];
        sum.square += r * change;
        sum.largest = glm::max(sum.largest, glm::abs(change));
      }
      return sum;
    });
    if (!glm::any(glm::greaterThan(left.largest, glm::dvec3(resolution))) || --n_left <= 0) return;
    const glm::dvec3 turn = ratio(left.square, old_rz);
    old_rz = left.square;
    parallel_blocks(n, rows_per_block, [&](std::size_t begin, std::size_t end) {
      for (std::size_t u = begin; u < end; ++u)
        at.direction[u] = free_residual(u) / matrix.diagonal[u] + turn * at.direction[u];
    });
    step = ratio(old_rz, sum_over_blocks(n, [&](std::size_t begin, std::size_t end) {
                   glm::dvec3 sum(0);
                   for (std::size_t u = begin; u < end; ++u) sum += at.direction[u] * set_image(u);
                   return sum;
                 }));
  }
}

/// Holds at its bound what is beyond, with a step there as the new direction, and frees what the residual
/// pulls off. @returns how many of both.
std::size_t change_held(const Matrix& matrix, const Guess& guess, Iterate& at) {
  const double least_change = 100 * guess.resolution;
  return sum_over_blocks(at.x.size(), [&](std::size_t begin, std::size_t end) {
    std::size_t n_changed = 0;
    for (std::size_t u = begin; u < end; ++u)
      for (int c = 0; c < 3; ++c) {
        const double x = at.x[u][c], pull = at.residual[u][c] / matrix.diagonal[u];
        const bool is_low = x < -least_change, is_high = guess.is_below_1[u][c] && x > 1 + least_change;
        const bool was_free = at.is_free[u][c];
        const bool is_free = was_free ? !is_low && !is_high : (x < 0.5 ? pull : -pull) > least_change;
        at.direction[u][c] = was_free && !is_free ? (is_high ? 1 : 0) - x : 0;
        at.is_free[u][c] = is_free;
        n_changed += is_free != was_free;
      }
    return n_changed;
  });
}

struct Solution {
  std::vector<glm::dvec3> x;    ///< Within the bounds.
  std::size_t n_unsettled = 0;  ///< Unknowns that a step more would move by a 16-bit step or further.
};

/// Least squares with 0 <= x, and x <= 1 where the guess says so, by a primal-dual active set (Hintermüller,
/// Ito, Kunisch 2002). Scaled by its diagonal the matrix has eigenvalues between 1 / (2 + 144 α) and 4 on any
/// mesh: the mass matrix, scaled by its own, from 1/2 to 2 (Wathen 1987), to which the jumps, of four colours
/// each, add at most 72 α. So it takes few iterations, unless α is large. (From the samples: where it does
/// not come to its end, it has not gone far.)
Solution solve(const Matrix& matrix, std::vector<glm::dvec3> right, Guess guess) {
  constexpr double settled = 1.0 / 65535;
  const std::size_t n = right.size();
  Iterate at{.x = std::vector<glm::dvec3>(n, glm::dvec3(0)),
             .residual = std::move(right),
             .direction = std::move(guess.x),
             .image = std::vector<glm::dvec3>(n),
             .is_free = std::vector<glm::bvec3>(n, glm::bvec3(true))};
  int n_left = 2000;
  do descend(matrix, guess.resolution, n_left, at);
  while (change_held(matrix, guess, at) > 0 && n_left > 0);

  Solution solution{.x = std::move(at.x)};
  for (std::size_t u = 0; u < n; ++u) {
    glm::dvec3& x = solution.x[u];
    const glm::dvec3 before = x;
    x = glm::max(x, 0.0);
    for (int c = 0; c < 3; ++c)
      if (guess.is_below_1[u][c]) x[c] = std::min(x[c], 1.0);
    const glm::dvec3 step = at.residual[u] / matrix.diagonal[u] * glm::dvec3(at.is_free[u]);
    solution.n_unsettled +=
        !glm::all(glm::lessThan(glm::abs(step) + glm::abs(x - before), glm::dvec3(settled)));
  }
  return solution;
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
  const Unknowns unknowns = find_unknowns(mesh);

  System system = system_of(scene, unknowns, options.gradient_weight);
  Guess guess{.x = std::vector<glm::dvec3>(unknowns.count, glm::dvec3(0))};
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v) {
    const LinearRgb& c = baked.colors[v];
    if (system.is_free[v] && is_finite(c)) guess.x[unknowns.of[v]] = {c.r, c.g, c.b};
  }
  set_bounds(system, guess);
  const Solution solution = solve(system.matrix, std::move(system.right), std::move(guess));

  for (std::size_t v = 0; v < mesh.n_vertices(); ++v) {
    if (!system.is_free[v]) continue;  // keeps the sample
    const glm::dvec3& x = solution.x[unknowns.of[v]];
    baked.colors[v] = {static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])};
  }
  add_finding(
      baked.findings, "least_squares_unsettled", solution.n_unsettled,
      "colour[ is|s are] not settled: with so large a gradient weight slivers keep least squares from "
      "its end; other methods do not mind them");
  return baked;
}

}  // namespace lambake
