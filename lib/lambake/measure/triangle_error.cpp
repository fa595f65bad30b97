#include "lambake/measure/triangle_error.h"

#include <algorithm>
#include <utility>

#include "lambake/core/quadrature.h"
#include "lambake/shading/patch_parts.h"

namespace lambake {

TriangleError::TriangleError(const ComparedSurface& surface, std::size_t triangle,
                             std::span<const ErrorMeasure> measures)
    : surface_(surface),
      triangle_(triangle),
      measures_(measures),
      patch_(surface.patch(triangle)),
      has_texture_(surface.has_texture(triangle)),
      hides_emission_(surface.hides_emission(triangle)),
      finish_(surface.finish_at(triangle, glm::dvec3(1.0 / 3))) {
  if (!finish_.is_unlit) find_reaching_lights(surface.scene().lights, patch_, lights_);
  for (std::size_t m = 0; m < measures.size(); ++m)
    for (int c = 0; c < 3; ++c)
      colors_[m][c] = to_double(measures[m].colors[surface.mesh().triangles[triangle][c]]);
}

PerMeasure<glm::dvec3> TriangleError::operator()(const glm::dvec3& b) const {
  const Finish finish = has_texture_ ? surface_.finish_at(triangle_, b) : finish_;
  const glm::dvec3 f = reference_at(patch_, surface_.scene().lights, lights_, finish.is_unlit, b);
  PerMeasure<glm::dvec3> errors;
  for (std::size_t m = 0; m < measures_.size(); ++m) {
    const glm::dvec3 g = colors_[m] * b;
    const ErrorSpace space = measures_[m].space;
    const bool is_hidden = hides_emission_ && measures_[m].hides_emission;
    if (space == ErrorSpace::linear)
      errors[m] = finish.base * (g - f) - (is_hidden ? finish.emission : glm::dvec3(0));
    else
      errors[m] = compared((is_hidden ? glm::dvec3(0) : finish.emission) + finish.base * g, space) -
                  compared(finish.emission + finish.base * f, space);
  }
  return errors;
}

std::vector<glm::dmat3> TriangleError::parts() const {
  const std::vector<Light>& all = surface_.scene().lights;
  std::vector<glm::dmat3> parts = cut_at_terminators(patch_, all, lights_, 8), next;
  if (has_texture_)
    for (std::size_t n = surface_.n_triangles(), level = 0; n <= 4096 && level < 5; n *= 4, ++level) {
      next.clear();
      for (const glm::dmat3& part : parts)
        for (const glm::dmat3& quarter : quarters(part)) next.push_back(quarter);
      parts.swap(next);
    }
  quarter_wide_parts(patch_, all, lights_, parts);
  return parts;
}

std::optional<std::uint32_t> TriangleError::worst_light(const glm::dvec3& b) const {
  double worst = -1;
  std::optional<std::uint32_t> light;
  for (const std::uint32_t& i : lights_) {
    const std::span<const std::uint32_t> one(&i, 1);
    const auto& all = surface_.scene().lights;
    glm::dvec3 share = -reference_at(patch_, all, one, false, b);
    for (int c = 0; c < 3; ++c) {
      glm::dvec3 corner(0);
      corner[c] = 1;
      share += b[c] * reference_at(patch_, all, one, false, corner);
    }
    const double size = glm::length(finish_.base * share);
    if (size > worst) worst = size, light = i;
  }
  return light;
}

namespace {

double share_of_area(const glm::dmat3& part) {
  return std::abs(glm::determinant(part));
}

ErrorEstimate estimate(const TriangleError& error, const glm::dmat3& part) {
  const std::size_t n_measures = error.n_measures();
  ErrorEstimate result;
  PerMeasure<double> squares_4{};
  for (const QuadratureNode& node : quadrature_4) {
    const glm::dvec3 b = part * node.b;
    const auto errors = error(b);
    for (std::size_t m = 0; m < n_measures; ++m) {
      squares_4[m] += node.weight * glm::dot(errors[m], errors[m]) / 3;
      result.sums[m].see(errors[m], b);
    }
  }
  for (const QuadratureNode& node : quadrature_5) {
    const glm::dvec3 b = part * node.b;
    const auto errors = error(b);
    for (std::size_t m = 0; m < n_measures; ++m) result.sums[m].add(errors[m], node.weight, b);
  }
  for (std::size_t m = 0; m < n_measures; ++m)
    result.uncertainties[m] = std::abs(result.sums[m].square - squares_4[m]);
  return result;
}

/// The mean of |x| over a triangle, of x linear with these values at the corners.
double mean_absolute(double a, double b, double c) {
  if (a > b) std::swap(a, b);
  if (b > c) std::swap(b, c);
  if (a > b) std::swap(a, b);
  const double mean = (a + b + c) / 3;
  if (a >= 0 || c <= 0) return std::abs(mean);
  // What is below 0 is a triangle at corner a, or what is above one at corner c.
  if (b >= 0) return mean - 2 * a / 3 * (a / (b - a)) * (a / (c - a));
  return 2 * c / 3 * (c / (c - a)) * (c / (c - b)) - mean;
}

/// The mean of |e| over a part: as of the function that is linear on its quarters, to which is added what
/// that leaves of the mean; no less than the mean itself, which the six places may miss. The rules, which ask
/// for polynomials, are some percent off where e changes its sign.
/// @param at     the errors at the corners and at the middles of the sides (0,1), (1,2) and (2,0).
/// @param plain  the mean of e.
double mean_absolute(const std::array<double, 6>& at, double plain) {
  const auto& [a, b, c, ab, bc, ca] = at;
  const double of_linear = (mean_absolute(a, ab, ca) + mean_absolute(b, bc, ab) + mean_absolute(c, ca, bc) +
                            mean_absolute(ab, bc, ca)) /
                           4;
  const double plain_of_linear = (a + b + c + 3 * (ab + bc + ca)) / 12;
  return std::max(std::abs(plain), of_linear + plain_of_linear / of_linear * (plain - plain_of_linear));
}

/// Looks at the corners and the middles of the sides of a part as well, where the largest errors lie, and by
/// which the mean of |e| is mended where e changes its sign.
void see_sides(const TriangleError& error, const glm::dmat3& part, PerMeasure<ErrorSums>& sums) {
  std::array<PerMeasure<glm::dvec3>, 6> errors;
  for (int i = 0; i < 6; ++i) {
    const glm::dvec3 b = i < 3 ? part[i] : 0.5 * (part[i - 3] + part[(i - 2) % 3]);
    errors[i] = error(b);
    for (std::size_t m = 0; m < error.n_measures(); ++m) sums[m].see(errors[i][m], b);
  }
  for (std::size_t m = 0; m < error.n_measures(); ++m)
    for (int c = 0; c < 3; ++c) {
      std::array<double, 6> at;
      for (int i = 0; i < 6; ++i) at[i] = errors[i][m][c];
      const auto [least, greatest] = std::minmax_element(at.begin(), at.end());
      if (*least < 0 && *greatest > 0) sums[m].absolute[c] = mean_absolute(at, sums[m].plain[c]);
    }
}

/// A part of a triangle, and how urgently it is to be quartered: by how many tolerances its rules are apart.
struct Part {
  glm::dmat3 corners;
  int depth;
  ErrorEstimate estimate;
  double urgency;

  friend bool operator<(const Part& a, const Part& b) { return a.urgency < b.urgency; }
};

}  // namespace

ErrorEstimate look_at(const TriangleError& error) {
  ErrorEstimate total;
  for (const glm::dmat3& part : error.parts()) {
    ErrorEstimate here = estimate(error, part);
    see_sides(error, part, here.sums);
    total.add(here, share_of_area(part), error.n_measures());
  }
  return total;
}

PerMeasure<ErrorSums> integrate_triangle(const TriangleError& error, const PerMeasure<double>& tolerances) {
  constexpr int max_depth = 14;
  constexpr std::size_t max_parts = 15000;
  std::vector<Part> parts;  // A heap.
  const auto add = [&](const glm::dmat3& corners, int depth) {
    Part part{corners, depth, estimate(error, corners), 0};
    const double share = share_of_area(corners);
    for (std::size_t m = 0; depth < max_depth && m < error.n_measures(); ++m)
      part.urgency = std::max(part.urgency, part.estimate.uncertainties[m] * share / tolerances[m]);
    parts.push_back(part);
    std::push_heap(parts.begin(), parts.end());
  };
  for (const glm::dmat3& corners : error.parts()) add(corners, 0);
  while (parts.size() < max_parts &&
         parts.front().urgency * parts.front().urgency * static_cast<double>(parts.size()) > 1) {
    std::pop_heap(parts.begin(), parts.end());
    const Part worst = parts.back();
    parts.pop_back();
    for (const glm::dmat3& quarter : quarters(worst.corners)) add(quarter, worst.depth + 1);
  }
  ErrorEstimate total;
  for (const Part& part : parts) total.add(part.estimate, share_of_area(part.corners), error.n_measures());
  return total.sums;
}

void climb_to_largest(const TriangleError& error, ErrorSums& sums) {
  constexpr int n = 32;
  glm::dvec3 center(1.0 / 3);
  double size = 2.0 / 3;
  if (sums.max > 0) center = sums.max_at, size = 0.5;
  for (int round = 0; round < 5; ++round, size *= 0.15) {
    for (int i = -n; i <= n; ++i)
      for (int j = -n; j <= n; ++j) {
        glm::dvec3 b(0, center[1] + size * i / n, center[2] + size * j / n);
        b[0] = 1 - b[1] - b[2];
        if (b[0] < 0 || b[1] < 0 || b[2] < 0) continue;
        sums.see(error(b)[0], b);
      }
    center = sums.max_at;
  }
}

}  // namespace lambake
