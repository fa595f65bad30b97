#include "lambake/bake/least_squares_matrix.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "lambake/core/parallel.h"
#include "lambake/core/value_numbers.h"
#include "lambake/shading/point_ranges.h"

namespace lambake {
namespace {

constexpr std::uint32_t none = Unknowns::none;
constexpr std::size_t rows_per_block = SparseMatrix::rows_per_block;
constexpr std::size_t longest_step = std::numeric_limits<std::uint16_t>::max();

/// A triangle that takes part, as the matrix sees it.
struct Element {
  glm::uvec3 unknowns{0};
  double area = 0;  ///< Weighted, in Unknowns::unit_area.
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
  const Scene& scene;
  const Mesh& mesh;
  const Unknowns& unknowns;
  bool has_jumps;
  std::vector<std::uint32_t> starts{};   ///< The corners at unknown u: from starts[u] to starts[u + 1] in
  std::vector<std::uint32_t> corners{};  ///< these, 3·triangle + c, in the order of the triangles.

  std::span<const std::uint32_t> around(std::size_t u) const {
    return std::span(corners).subspan(starts[u], starts[u + 1] - starts[u]);
  }
  std::uint32_t unknown_at(std::size_t triangle, int c) const {
    return unknowns.of[mesh.triangles[triangle][c]];
  }
};

Elements elements_of(const Scene& scene, const Unknowns& unknowns, bool has_jumps) {
  const Mesh& mesh = scene.mesh;
  Elements elements{.scene = scene, .mesh = mesh, .unknowns = unknowns, .has_jumps = has_jumps};
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
  const Material& material = elements.scene.materials[elements.mesh.material_of(triangle)];
  element.area = weight_of(material) * 0.5 * doubled_area / elements.unknowns.unit_area;
  for (int i = 0; i < 3; ++i) {
    element.cotangents[i] = glm::dot(p[(i + 1) % 3] - p[i], p[(i + 2) % 3] - p[i]) / doubled_area;
    if (elements.has_jumps)
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
  for (int k = 0; k < 3; ++k) {
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

/// Whether more than one in 16 triangles has corners too far apart for short steps.
bool is_scattered(const Mesh& mesh, const Unknowns& unknowns) {
  std::size_t n_far = 0;
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    if (!unknowns.takes_part[f]) continue;
    const glm::uvec3& t = mesh.triangles[f];
    const auto [low, high] = std::minmax({unknowns.of[t.x], unknowns.of[t.y], unknowns.of[t.z]});
    n_far += high - low > longest_step;
  }
  return n_far > mesh.n_triangles() / 16;
}

/// Gives those that lie near each other and face alike numbers that are near.
void number_by_place(const Mesh& mesh, Unknowns& unknowns) {
  std::vector<std::uint32_t> numbers(unknowns.count, none);
  std::uint32_t n = 0;
  for (const KeyedPoint& item : sort_points(mesh.positions, mesh.normals, bounds_of(mesh.positions))) {
    const std::uint32_t u = unknowns.of[item.point];
    if (u != none && numbers[u] == none) numbers[u] = n++;
  }
  for (std::uint32_t& number : numbers)
    if (number == none) number = n++;
  for (std::uint32_t& u : unknowns.of)
    if (u != none) u = numbers[u];
}

}  // namespace

Unknowns find_unknowns(const Scene& scene) {
  const Mesh& mesh = scene.mesh;
  Unknowns unknowns;
  unknowns.of.assign(mesh.n_vertices(), none);
  unknowns.takes_part.assign(mesh.n_triangles(), false);
  ValueNumbers<9> numbers;
  numbers.reserve(mesh.n_vertices());
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    const Material& material = scene.materials[mesh.material_of(f)];
    if (material.is_unlit) continue;
    const double area = weight_of(material) * area_of(patch_of(mesh, f));
    if (!(area > 0)) continue;
    unknowns.takes_part[f] = true;
    unknowns.unit_area = std::max(unknowns.unit_area, area);
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
  if (is_scattered(mesh, unknowns)) number_by_place(mesh, unknowns);
  return unknowns;
}

SparseMatrix least_squares_matrix(const Scene& scene, const Unknowns& unknowns, double gradient_weight) {
  const Elements elements = elements_of(scene, unknowns, gradient_weight > 0);
  const std::size_t n = unknowns.count;
  SparseMatrix matrix{.blocks = std::vector<SparseRows>((n + rows_per_block - 1) / rows_per_block),
                      .roots = std::vector<float>(n)};
  parallel_blocks(n, rows_per_block, [&](std::size_t begin, std::size_t end) {
    RecentElements recent(elements);
    SparseRows rows;
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
        if (step > longest_step) {
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
    SparseRows& rows = matrix.blocks[begin / rows_per_block];
    const auto scale = [&](std::size_t row, std::size_t column) {
      return matrix.roots[row] / matrix.roots[column];
    };
    for (std::size_t u = begin, e = 0; u < end; ++u)
      for (; e < rows.ends[u - begin]; ++e) rows.values[e] *= scale(u, u + rows.steps[e]);
    for (FarEntry& entry : rows.far) entry.value *= scale(entry.row, entry.column);
  });
  return matrix;
}

void multiply(const SparseMatrix& matrix, const std::vector<float>& x, SparseProduct& product) {
  product.blocks.resize(matrix.blocks.size());
  parallel_blocks(x.size(), rows_per_block, [&](std::size_t begin, std::size_t end) {
    const SparseRows& rows = matrix.blocks[begin / rows_per_block];
    std::vector<double> sums(end - begin + rows.n_beyond, 0.0);
    for (std::size_t u = begin, e = 0; u < end; ++u) {
      double sum = x[u];
      for (; e < rows.ends[u - begin]; ++e) {
        const std::size_t column = u + rows.steps[e];
        sum += rows.values[e] * x[column];
        sums[column - begin] += rows.values[e] * x[u];
      }
      sums[u - begin] += sum;
    }
    product.blocks[begin / rows_per_block].assign(sums.begin(), sums.end());
  });
  const auto at = [&](std::size_t u) -> float& {
    return product.blocks[u / rows_per_block][u % rows_per_block];
  };
  for (std::size_t b = 0; b < product.blocks.size(); ++b) {
    for (std::size_t u = (b + 1) * rows_per_block; u < b * rows_per_block + product.blocks[b].size(); ++u)
      at(u) += product.blocks[b][u - b * rows_per_block];
    for (const FarEntry& entry : matrix.blocks[b].far) {
      at(entry.row) += entry.value * x[entry.column];
      at(entry.column) += entry.value * x[entry.row];
    }
  }
}

}  // namespace lambake
