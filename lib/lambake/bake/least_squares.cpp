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

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t triangles_per_block = 256;
constexpr std::size_t rows_per_block = 16384;
constexpr float LinearRgb::*channels[] = {&LinearRgb::r, &LinearRgb::g, &LinearRgb::b};

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

/// The colours to be found.
struct Unknowns {
  /// V: numbered by the triangles, so that neighbours have numbers that are near. Vertices that are alike in
  /// all that lights them share one, so that a texture seam does not show; none where no triangle takes part.
  std::vector<std::uint32_t> of;
  std::vector<bool> takes_part;  ///< F: it is lit and has an area.
  double largest_area = 0;
  std::size_t count = 0;
};

Unknowns find_unknowns(const Scene& scene) {
  const Mesh& mesh = scene.mesh;
  Unknowns unknowns;
  unknowns.of.assign(mesh.n_vertices(), none);
  unknowns.takes_part.assign(mesh.n_triangles(), false);
  ValueNumbers<9> numbers;
  numbers.reserve(mesh.n_vertices());
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    if (scene.materials[mesh.material_of(f)].is_unlit) continue;
    const double area = area_of(patch_of(mesh, f));
    if (!(area > 0)) continue;
    unknowns.takes_part[f] = true;
    unknowns.largest_area = std::max(unknowns.largest_area, area);
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t v = mesh.triangles[f][c];
      if (unknowns.of[v] != none) continue;
      const glm::vec3 p = mesh.positions[v] + 0.0f, n = mesh.normals[v] + 0.0f;
      const LinearRgb color = mesh.colors.empty() ? LinearRgb{} : mesh.colors[v];
      unknowns.of[v] =
          numbers.number_of({p.x, p.y, p.z, n.x, n.y, n.z, color.r + 0.0f, color.g + 0.0f, color.b + 0.0f});
    }
  }
  unknowns.count = numbers.size();
  return unknowns;
}

/// A triangle that takes part, as the matrix sees it.
struct Element {
  glm::uvec3 unknowns{0};
  double area = 0;  ///< In the largest of the mesh.
  glm::dvec3 cotangents{0.0};
  glm::uvec3 across{none};  ///< For its side from corner c to the next: see corner_across().
};

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

/// The triangles that take part, and which are around an unknown.
struct Elements {
  const Mesh& mesh;
  const Unknowns& unknowns;
  std::vector<std::uint32_t> starts{};   ///< The corners at unknown u: from starts[u] to starts[u + 1] in
  std::vector<std::uint32_t> corners{};  ///< these, 3·triangle + c, in the order of the triangles.

  std::span<const std::uint32_t> around(std::size_t u) const {
    return std::span(corners).subspan(starts[u], starts[u + 1] - starts[u]);
  }
  std::uint32_t unknown_at(std::size_t triangle, int c) const {
    return unknowns.of[mesh.triangles[triangle][c]];
  }
};

Elements elements_of(const Mesh& mesh, const Unknowns& unknowns) {
  Elements elements{.mesh = mesh, .unknowns = unknowns};
  const auto for_each_corner = [&](auto&& visit) {
    for (std::uint32_t f = 0; f < mesh.n_triangles(); ++f)
      if (unknowns.takes_part[f])
        for (int c = 0; c < 3; ++c) visit(elements.unknown_at(f, c), 3 * f + static_cast<std::uint32_t>(c));
  };
  std::vector<std::uint32_t>& starts = elements.starts;
  starts.assign(unknowns.count + 2, 0);  // Of u at u + 1, which filling moves to the start of u + 1.
  for_each_corner([&](std::uint32_t u, std::uint32_t) { ++starts[u + 2]; });
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  elements.corners.resize(starts.back());
  for_each_corner([&](std::uint32_t u, std::uint32_t corner) { elements.corners[starts[u + 1]++] = corner; });
  return elements;
}

/// The corner (3·triangle + c) at which the side from `a` to `b` of a triangle begins in its neighbour; none
/// unless there is just one, that winds alike.
std::uint32_t corner_across(const Elements& elements, std::uint32_t a, std::uint32_t b) {
  // By the end that has fewer triangles around: there may be a hub of many.
  const bool is_at_a = elements.around(a).size() <= elements.around(b).size();
  const std::uint32_t other = is_at_a ? b : a;
  std::uint32_t across = none;
  int n_alike = 0;  // From a to b, the triangle itself among them.
  for (const std::uint32_t corner : elements.around(is_at_a ? a : b)) {
    const std::size_t f = corner / 3;
    const int c = static_cast<int>(corner % 3), previous = (c + 2) % 3;
    const bool is_out = elements.unknown_at(f, (c + 1) % 3) == other,
               is_in = elements.unknown_at(f, previous) == other;
    if (!is_out && !is_in) continue;
    if (is_out == is_at_a) {
      if (++n_alike > 1) return none;
    } else {
      if (across != none) return none;
      across = is_out ? corner : static_cast<std::uint32_t>(3 * f) + static_cast<std::uint32_t>(previous);
    }
  }
  return across;
}

Element element_of(const Elements& elements, std::size_t triangle) {
  glm::dmat3 p;
  Element element;
  for (int c = 0; c < 3; ++c) {
    p[c] = elements.mesh.positions[elements.mesh.triangles[triangle][c]];
    element.unknowns[c] = elements.unknown_at(triangle, c);
  }
  const double doubled_area = glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
  element.area = 0.5 * doubled_area / elements.unknowns.largest_area;
  for (int i = 0; i < 3; ++i) {
    element.cotangents[i] = glm::dot(p[(i + 1) % 3] - p[i], p[(i + 2) % 3] - p[i]) / doubled_area;
    element.across[i] = corner_across(elements, element.unknowns[i], element.unknowns[(i + 1) % 3]);
  }
  return element;
}

/// Keeps elements for a while: each has a part in some ten rows, which mostly follow soon.
class RecentElements {
 public:
  explicit RecentElements(const Elements& elements)
      : elements_(elements), kept_(std::clamp<std::size_t>(elements.mesh.n_triangles() / 32, 1, 16384)) {}
  Element operator[](std::uint32_t triangle) {
    Kept& kept = kept_[triangle % kept_.size()];
    if (kept.triangle != triangle) kept = {triangle, element_of(elements_, triangle)};
    return kept.element;
  }

 private:
  struct Kept {
    std::uint32_t triangle = none;
    Element element;
  };
  const Elements& elements_;
  std::vector<Kept> kept_;
};

/// An entry of the matrix that is far from the diagonal.
struct FarEntry {
  std::uint32_t row = 0, column = 0;
  float value = 0;
};

/// A block of consecutive rows of a symmetric matrix of diagonal 1: of each row what is right of that.
struct Rows {
  std::vector<std::uint32_t> ends;   ///< Of each row, in `steps` and `values`.
  std::vector<std::uint16_t> steps;  ///< Column − row, ascending in each row.
  std::vector<float> values;
  std::vector<FarEntry> far;  ///< Where the step is too long for 16 bits.
  std::size_t n_beyond = 0;   ///< How far steps reach behind the last row.
};

/// D^-½ A D^-½ for the matrix A of the normal equations and its diagonal D.
struct Matrix {
  std::vector<Rows> blocks;  ///< Of `rows_per_block`, the last one of fewer.
  std::vector<float> roots;  ///< D^½.
};

using Entries = std::vector<std::pair<std::uint32_t, double>>;  // columns and values

/// Adds what one triangle gives to the row of the unknown at its corner `corner` (3·triangle + c), from the
/// diagonal on.
void add_to_row(RecentElements& elements, std::uint32_t corner, double gradient_weight, Entries& row) {
  const Element f = elements[corner / 3];
  const int i = static_cast<int>(corner % 3);
  const auto add = [&](std::uint32_t column, double value) {
    if (column >= f.unknowns[i]) row.emplace_back(column, value);
  };
  glm::dvec3 values(f.area / 12);
  values[i] *= 2;
  for (int k = 0; k < 3 && gradient_weight > 0; ++k) {
    if (f.across[k] == none) continue;
    // l times the jump is s + t over the corners of both. Of a row of an end of the side this is what s_i
    // gives; what t gives comes from g.
    const Element g = elements[f.across[k] / 3];
    const int m = static_cast<int>(f.across[k] % 3);
    const glm::dvec3 s = slopes_across(f, k), t = slopes_across(g, m);
    const double scale = gradient_weight * std::min(f.area, g.area) *
                         std::min(height_over_side(f, k), height_over_side(g, m)) * s[i];
    values += scale * s;
    values[k] += scale * t[(m + 1) % 3];
    values[(k + 1) % 3] += scale * t[m];
    add(g.unknowns[(m + 2) % 3], scale * t[(m + 2) % 3]);
  }
  for (int j = 0; j < 3; ++j) add(f.unknowns[j], values[j]);
}

/// Sorts the entries by their columns and adds those of the same.
void merge(Entries& row) {
  std::sort(row.begin(), row.end());
  std::size_t n = 0;
  for (const auto& [column, value] : row)
    if (n > 0 && row[n - 1].first == column)
      row[n - 1].second += value;
    else
      row[n++] = {column, value};
  row.resize(n);
}

/// Each row gathers from the triangles around its unknown.
Matrix assemble(const Elements& elements, double gradient_weight) {
  const std::size_t n = elements.unknowns.count;
  Matrix matrix{.blocks = std::vector<Rows>((n + rows_per_block - 1) / rows_per_block),
                .roots = std::vector<float>(n)};
  parallel_blocks(n, rows_per_block, [&](std::size_t begin, std::size_t end) {
    RecentElements recent(elements);
    Rows rows;
    constexpr std::size_t n_usual = 7;  // Entries of a row.
    rows.steps.reserve(n_usual * (end - begin));
    rows.values.reserve(n_usual * (end - begin));
    Entries row;
    for (std::size_t u = begin; u < end; ++u) {
      row.clear();
      for (const std::uint32_t corner : elements.around(u)) add_to_row(recent, corner, gradient_weight, row);
      merge(row);
      const double diagonal = row.front().second;
      matrix.roots[u] = static_cast<float>(std::sqrt(diagonal));
      for (const auto& [column, value] : std::span(row).subspan(1)) {
        const std::size_t step = column - u;
        const auto by_diagonal = static_cast<float>(value / diagonal);  // So that it is in float's range.
        if (step > std::numeric_limits<std::uint16_t>::max()) {
          rows.far.push_back({static_cast<std::uint32_t>(u), column, by_diagonal});
          continue;
        }
        rows.steps.push_back(static_cast<std::uint16_t>(step));
        rows.values.push_back(by_diagonal);
        rows.n_beyond = std::max(rows.n_beyond, column + 1 - std::min<std::size_t>(column + 1, end));
      }
      rows.ends.push_back(static_cast<std::uint32_t>(rows.steps.size()));
    }
    rows.steps.shrink_to_fit();
    rows.values.shrink_to_fit();
    matrix.blocks[begin / rows_per_block] = std::move(rows);
  });
  parallel_blocks(n, rows_per_block, [&](std::size_t begin, std::size_t end) {
    Rows& rows = matrix.blocks[begin / rows_per_block];
    const auto scale = [&](std::size_t row, std::size_t column) {
      return matrix.roots[row] / matrix.roots[column];
    };
    for (std::size_t u = begin, e = 0; u < end; ++u)
      for (; e < rows.ends[u - begin]; ++e) rows.values[e] *= scale(u, u + rows.steps[e]);
    for (FarEntry& entry : rows.far) entry.value *= scale(entry.row, entry.column);
  });
  return matrix;
}

/// A product with the matrix: by block its rows and, behind them, what the block adds to rows that follow.
using Product = std::vector<std::vector<float>>;

/// Blocks side by side, each with its own sums; what they have for each other is added in their order.
void multiply(const Matrix& matrix, const std::vector<float>& x, Product& product) {
  product.resize(matrix.blocks.size());
  parallel_blocks(x.size(), rows_per_block, [&](std::size_t begin, std::size_t end) {
    const Rows& rows = matrix.blocks[begin / rows_per_block];
    std::vector<float>& sums = product[begin / rows_per_block];
    sums.assign(end - begin + rows.n_beyond, 0.0f);
    for (std::size_t u = begin, e = 0; u < end; ++u) {
      float sum = x[u];
      for (; e < rows.ends[u - begin]; ++e) {
        const std::size_t column = u + rows.steps[e];
        sum += rows.values[e] * x[column];
        sums[column - begin] += rows.values[e] * x[u];
      }
      sums[u - begin] += sum;
    }
  });
  const auto at = [&](std::size_t u) -> float& { return product[u / rows_per_block][u % rows_per_block]; };
  for (std::size_t b = 0; b < product.size(); ++b) {
    for (std::size_t u = (b + 1) * rows_per_block; u < b * rows_per_block + product[b].size(); ++u)
      at(u) += product[b][u - b * rows_per_block];
    for (const FarEntry& entry : matrix.blocks[b].far) {
      at(entry.row) += entry.value * x[entry.column];
      at(entry.column) += entry.value * x[entry.row];
    }
  }
}

/// By unknown, divided by the root of its diagonal.
struct RightSide {
  std::array<std::vector<float>, 3> integrals;  ///< ∫ b_i D⊗E dA, by channel.
  std::vector<float> masses;                    ///< ∫ b_i dA.
};

RightSide right_side(const Scene& scene, const Unknowns& unknowns, const Matrix& matrix) {
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
  Product image{};                 ///< A · direction.
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
void descend(const Matrix& matrix, double resolution, int& n_left, Iterate& at) {
  const std::size_t n = at.x.size();
  const auto free_residual = [&](std::size_t u) { return at.is_free[u] ? at.residual[u] : 0.0f; };
  const auto image = [&](std::size_t u) { return at.image[u / rows_per_block][u % rows_per_block]; };
  multiply(matrix, at.direction, at.image);
  double step = 1, old_square = 0;
  for (;;) {
    const Distance left = sum_over_blocks(n, [&](std::size_t begin, std::size_t end) {
      Distance sum;
      const auto along = static_cast<float>(step);
      for (std::size_t u = begin; u < end; ++u) {
        at.x[u] += along * at.direction[u];
        at.residual[u] -= along * image(u);
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
      for (std::size_t u = begin; u < end; ++u) sum += double(at.direction[u]) * image(u);
      return sum;
    });
    step = curvature > 0 ? old_square / curvature : 0;
  }
}

/// Holds at its bound what is beyond, with a step there as the new direction, and frees what the residual
/// pulls off. @returns how many of both.
std::size_t change_held(const Matrix& matrix, const Bounds& bounds, int channel, Iterate& at) {
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
std::vector<float> solve(const Matrix& matrix, const Bounds& bounds, int channel, Iterate at,
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
  const Matrix matrix = assemble(elements_of(mesh, unknowns), options.gradient_weight);
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
