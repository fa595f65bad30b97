#include "lambake/measure/surface_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/core/quadrature.h"
#include "lambake/geometry/triangle_distance.h"
#include "lambake/measure/surface.h"

namespace lambake {
namespace {

/// Mean values over (a part of) a triangle, and the largest that was met in its three channels.
struct Sums {
  double square = 0;                     ///< Over the channels.
  glm::dvec3 absolute{0.0}, plain{0.0};  ///< By channel.
  double max = -1;                       ///< |worst|; below 0 where nothing was seen.
  double worst = 0;                      ///< Signed, of the worst channel.
  glm::dvec3 max_at{1, 0, 0};

  void see(double error, const glm::dvec3& b) {
    if (std::abs(error) > max) max = std::abs(error), worst = error, max_at = b;
  }
  void see(const glm::dvec3& e, const glm::dvec3& b) {
    for (int c = 0; c < 3; ++c) see(e[c], b);
  }
  void add(const glm::dvec3& e, double weight, const glm::dvec3& b) {
    square += weight * glm::dot(e, e) / 3;
    absolute += weight * glm::abs(e);
    plain += weight * e;
    see(e, b);
  }
  void add(const Sums& other, double weight) {
    square += weight * other.square;
    absolute += weight * other.absolute;
    plain += weight * other.plain;
    see(other);
  }
  void see(const Sums& other) {
    if (other.max >= 0) see(other.worst, other.max_at);
  }
};

/// What is compared with per-pixel lighting: colours of the vertices, and the space.
struct Measure {
  const std::vector<LinearRgb>& colors;
  ErrorSpace space;
};

/// One value for each of the measures of a pass.
constexpr std::size_t most_measures = 3;
template <typename T>
using PerMeasure = std::array<T, most_measures>;

/// G − F on one triangle, of all measures: F, which is what costs, is evaluated once.
class TriangleError {
 public:
  TriangleError(const ComparedSurface& surface, std::size_t triangle, std::span<const Measure> measures)
      : surface_(surface),
        triangle_(triangle),
        measures_(measures),
        patch_(surface.patch(triangle)),
        has_texture_(surface.has_texture(triangle)),
        finish_(surface.finish_at(triangle, glm::dvec3(1.0 / 3))) {
    if (!finish_.is_unlit) find_reaching_lights(surface.scene().lights, patch_, lights_);
    for (std::size_t m = 0; m < measures.size(); ++m)
      for (int c = 0; c < 3; ++c)
        colors_[m][c] = to_double(measures[m].colors[surface.mesh().triangles[triangle][c]]);
  }

  std::size_t n_measures() const { return measures_.size(); }

  PerMeasure<glm::dvec3> operator()(const glm::dvec3& b) const {
    const Finish finish = has_texture_ ? surface_.finish_at(triangle_, b) : finish_;
    const glm::dvec3 f = reference_at(patch_, surface_.scene().lights, lights_, finish.is_unlit, b);
    PerMeasure<glm::dvec3> errors;
    for (std::size_t m = 0; m < measures_.size(); ++m) {
      const glm::dvec3 g = colors_[m] * b;
      const ErrorSpace space = measures_[m].space;
      errors[m] = space == ErrorSpace::linear ? finish.base * (g - f)
                                              : compared(finish.emission + finish.base * g, space) -
                                                    compared(finish.emission + finish.base * f, space);
    }
    return errors;
  }

  /// The triangle cut along the terminators of its lights (their chords, where they are curves), as long as
  /// that makes few parts: there the error has its kinks. Then quartered where a light is nearer than a part
  /// is wide, or its cone narrower: what it lights must not fall between the places looked at. Where few
  /// triangles have all of a texture between them, each is quartered for that.
  std::vector<glm::dmat3> parts() const {
    constexpr std::size_t max_parts = 8, max_quarters = 512;
    constexpr int max_depth = 14;
    std::vector<glm::dmat3> parts{glm::dmat3(1.0)}, next;
    for (const std::uint32_t light : lights_) {
      next.clear();
      for (const glm::dmat3& part : parts)
        cut_at_terminator(surface_.scene().lights[light], patch_, part, next);
      if (next.size() > max_parts) break;
      parts.swap(next);
    }
    if (has_texture_)
      for (std::size_t n = surface_.n_triangles(), level = 0; n <= 4096 && level < 5; n *= 4, ++level) {
        next.clear();
        for (const glm::dmat3& part : parts)
          for (const glm::dmat3& quarter : quarters(part)) next.push_back(quarter);
        parts.swap(next);
      }
    std::vector<glm::dmat3> narrow;
    for (int depth = 0; depth < max_depth && narrow.size() + parts.size() < max_quarters; ++depth) {
      next.clear();
      for (const glm::dmat3& part : parts)
        if (is_wide(part))
          for (const glm::dmat3& quarter : quarters(part)) next.push_back(quarter);
        else
          narrow.push_back(part);
      parts.swap(next);
    }
    parts.insert(parts.end(), narrow.begin(), narrow.end());
    return parts;
  }

  /// The light whose share of the error at `b` is the largest; none where no light reaches the triangle.
  std::optional<std::uint32_t> worst_light(const glm::dvec3& b) const {
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

 private:
  /// Whether a part is wider than a light is away, or than what its cone has lit there.
  bool is_wide(const glm::dmat3& part) const {
    const glm::dmat3 p = patch_.positions * part;
    const glm::dvec3 center = (p[0] + p[1] + p[2]) / 3.0;
    const double width =
        std::max({glm::length(p[1] - p[0]), glm::length(p[2] - p[1]), glm::length(p[0] - p[2])});
    return std::any_of(lights_.begin(), lights_.end(), [&](std::uint32_t i) {
      const Light& light = surface_.scene().lights[i];
      if (light.type == LightType::directional) return false;
      const glm::dvec3 at(light.position), to_center = center - at;
      double slope = 1;
      if (light.type == LightType::spot) {
        slope = std::tan(std::min(double(light.outer_cone_rad), 1.57));
        const glm::dvec3 axis(light.spot_direction);
        const double along = glm::dot(to_center, axis), off = glm::length(to_center - along * axis);
        if (off - width > std::max(0.0, along + width) * slope) return false;  // The cone misses it.
        slope = std::min(slope, 1.0);
      }
      if (width <= slope * (glm::length(to_center) - width)) return false;  // Far away.
      return width > slope * distance_from_origin(p[0] - at, p[1] - at, p[2] - at);
    });
  }

  const ComparedSurface& surface_;
  std::size_t triangle_;
  std::span<const Measure> measures_;
  Patch patch_;
  PerMeasure<glm::dmat3> colors_;  ///< Column i at corner i.
  bool has_texture_;
  Finish finish_;
  std::vector<std::uint32_t> lights_;
};

double share_of_area(const glm::dmat3& part) {
  return std::abs(glm::determinant(part));
}

/// Means over (a part of) a triangle by the rule of degree 5, and how far those of degree 4 are from them in
/// Σ e².
struct Estimate {
  PerMeasure<Sums> sums;
  PerMeasure<double> uncertainties{};

  void add(const Estimate& other, double weight, std::size_t n_measures) {
    for (std::size_t m = 0; m < n_measures; ++m) {
      sums[m].add(other.sums[m], weight);
      uncertainties[m] += weight * other.uncertainties[m];
    }
  }
};

Estimate estimate(const TriangleError& error, const glm::dmat3& part) {
  const std::size_t n_measures = error.n_measures();
  Estimate result;
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
  if (b >= 0) return mean - 2 * a * a * a / (3 * (b - a) * (c - a));
  return 2 * c * c * c / (3 * (c - a) * (c - b)) - mean;
}

/// The mean of |e| over a part: as of the function that is linear on its quarters, to which is added what
/// that leaves of the mean. The rules, which ask for polynomials, are some percent off where e changes its
/// sign.
/// @param at     the errors at the corners and at the middles of the sides (0,1), (1,2) and (2,0).
/// @param plain  the mean of e.
double mean_absolute(const std::array<double, 6>& at, double plain) {
  const auto& [a, b, c, ab, bc, ca] = at;
  const double of_linear = (mean_absolute(a, ab, ca) + mean_absolute(b, bc, ab) + mean_absolute(c, ca, bc) +
                            mean_absolute(ab, bc, ca)) /
                           4;
  const double plain_of_linear = (a + b + c + 3 * (ab + bc + ca)) / 12;
  return of_linear + plain_of_linear / of_linear * (plain - plain_of_linear);
}

/// Looks at the corners and the middles of the sides of a part as well, where the largest errors lie, and by
/// which the mean of |e| is mended where e changes its sign.
void see_sides(const TriangleError& error, const glm::dmat3& part, PerMeasure<Sums>& sums) {
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
  Estimate estimate;
  double urgency;

  friend bool operator<(const Part& a, const Part& b) { return a.urgency < b.urgency; }
};

/// Adaptive quadrature of one triangle: of n parts the most urgent one is quartered until none is above
/// 1/√n. What is left has either sign and adds up as its squares do, to the tolerance of each measure.
PerMeasure<Sums> integrate_triangle(const TriangleError& error, const PerMeasure<double>& tolerances) {
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
  Estimate total;
  for (const Part& part : parts) total.add(part.estimate, share_of_area(part.corners), error.n_measures());
  return total.sums;
}

/// The largest error on the triangle, of the only measure: the best of a dense grid, then of ever smaller
/// ones around it.
void climb(const TriangleError& error, Sums& sums) {
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

/// Area integrals over a group of triangles.
struct Totals {
  double area = 0;
  PerMeasure<double> square{}, absolute{}, plain{};
  PerMeasure<double> max{};           ///< The largest |e| that was met.
  PerMeasure<double> n_with_error{};  ///< Triangles.

  void add(const PerMeasure<Sums>& sums, double weight) {
    area += weight;
    for (std::size_t m = 0; m < most_measures; ++m) {
      square[m] += weight * sums[m].square;
      absolute[m] += weight * glm::dot(sums[m].absolute, glm::dvec3(1.0 / 3));
      plain[m] += weight * glm::dot(sums[m].plain, glm::dvec3(1.0 / 3));
      max[m] = std::max(max[m], sums[m].max);
      n_with_error[m] += weight * sums[m].square > 0;
    }
  }
  void add(const Totals& other) {
    area += other.area;
    for (std::size_t m = 0; m < most_measures; ++m) {
      square[m] += other.square[m];
      absolute[m] += other.absolute[m];
      plain[m] += other.plain[m];
      max[m] = std::max(max[m], other.max[m]);
      n_with_error[m] += other.n_with_error[m];
    }
  }
};

/// Triangles whose totals are kept together: where one is integrated more closely, the others are looked at
/// again.
constexpr std::size_t group_size = 8;
constexpr std::size_t groups_in_block = 32;  // Whole groups: no two threads add to one.

/// What integrating keeps: little of each triangle, as there are many. What else is wanted of one is
/// evaluated again.
struct Integrals {
  std::vector<Totals> groups;
  std::vector<PerMeasure<float>> uncertainties;  ///< F': square roots of those of the first look.
  /// How far a triangle may be off, by area: one without a texture, and one with.
  PerMeasure<double> allowed, allowed_noise;

  PerMeasure<double> tolerances(const ComparedSurface& surface, std::size_t f) const {
    PerMeasure<double> tolerances = surface.has_texture(f) ? allowed_noise : allowed;
    const double area = area_of(surface.patch(f));
    for (double& tolerance : tolerances) tolerance /= area;
    return tolerances;
  }
};

Totals total_of(const Integrals& integrals) {
  Totals total;
  for (const Totals& group : integrals.groups) total.add(group);
  return total;
}

/// The first look at a triangle: its parts by their rules, and where the largest errors lie.
Estimate look_at(const TriangleError& error) {
  Estimate total;
  for (const glm::dmat3& part : error.parts()) {
    Estimate here = estimate(error, part);
    see_sides(error, part, here.sums);
    total.add(here, share_of_area(part), error.n_measures());
  }
  return total;
}

/// Whether the first look at a triangle is not exact enough for one of the measures that count.
bool is_open(const ComparedSurface& surface, const Integrals& integrals, std::size_t f,
             const PerMeasure<bool>& counts = {true, true, true}) {
  const PerMeasure<float>& roots = integrals.uncertainties[f];
  if (roots == PerMeasure<float>{}) return false;
  const PerMeasure<double> tolerances = integrals.tolerances(surface, f);
  for (std::size_t m = 0; m < most_measures; ++m)
    if (counts[m] && double(roots[m]) * roots[m] > tolerances[m]) return true;
  return false;
}

/// Means over a triangle, as exact as they need be.
PerMeasure<Sums> sums_of(const ComparedSurface& surface, std::span<const Measure> measures,
                         const Integrals& integrals, std::size_t f) {
  if (area_of(surface.patch(f)) == 0) return {};
  const TriangleError error(surface, f, measures);
  const PerMeasure<Sums> rough = look_at(error).sums;
  if (!is_open(surface, integrals, f)) return rough;
  PerMeasure<Sums> sums = integrate_triangle(error, integrals.tolerances(surface, f));
  for (std::size_t m = 0; m < measures.size(); ++m) sums[m].see(rough[m]);
  return sums;
}

/// @param worst  for each of the first measures F' floats, which are set to the worst difference of each
/// triangle.
Integrals integrate_surface(const ComparedSurface& surface, std::span<const Measure> measures,
                            std::span<std::vector<float>* const> worst) {
  const std::size_t n = surface.n_triangles();
  Integrals result;
  result.groups.resize((n + group_size - 1) / group_size);
  result.uncertainties.resize(n);
  for (auto* values : {&result.allowed, &result.allowed_noise})
    values->fill(std::numeric_limits<double>::infinity());
  for (std::vector<float>* values : worst) values->assign(n, 0);
  const auto take = [&](std::size_t f, const PerMeasure<Sums>& sums) {
    result.groups[f / group_size].add(sums, area_of(surface.patch(f)));
    for (std::size_t m = 0; m < worst.size(); ++m) (*worst[m])[f] = static_cast<float>(sums[m].worst);
  };
  parallel_blocks(n, groups_in_block * group_size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      if (area_of(surface.patch(f)) == 0) continue;
      const Estimate total = look_at(TriangleError(surface, f, measures));
      for (std::size_t m = 0; m < measures.size(); ++m)
        result.uncertainties[f][m] = static_cast<float>(std::sqrt(total.uncertainties[m]));
      take(f, total.sums);
    }
  });

  // Each triangle may be wrong by its equal part of 4e-4 of the whole: the RMSE by half of that. The noise of
  // a texture has either sign and adds up as its squares do: there 1e-4 of the whole over √n is enough, and
  // leaves room for tiles that are all alike. The whole is known only roughly at first, so this is done again
  // where it turns out smaller.
  PerMeasure<double> previous_totals;
  previous_totals.fill(std::numeric_limits<double>::infinity());
  for (int round = 0; round < 4; ++round) {
    const Totals totals = total_of(result);
    PerMeasure<bool> is_new{};
    for (std::size_t m = 0; m < measures.size(); ++m) {
      is_new[m] = totals.square[m] < 0.9 * previous_totals[m];
      if (!is_new[m]) continue;
      previous_totals[m] = totals.square[m];
      const double n_with_error = std::max(1.0, totals.n_with_error[m]);
      result.allowed[m] = std::min(result.allowed[m], 4e-4 * totals.square[m] / n_with_error);
      result.allowed_noise[m] =
          std::min(result.allowed_noise[m], 1e-4 * totals.square[m] / std::sqrt(n_with_error));
    }
    if (is_new == PerMeasure<bool>{}) break;
    parallel_blocks(n, group_size, [&](std::size_t begin, std::size_t end) {
      bool has_open = false;
      for (std::size_t f = begin; f < end; ++f) has_open |= is_open(surface, result, f, is_new);
      if (!has_open) return;
      result.groups[begin / group_size] = {};
      for (std::size_t f = begin; f < end; ++f) take(f, sums_of(surface, measures, result, f));
    });
  }
  return result;
}

/// The places of the largest errors of measure m, in at most 8 triangles, the largest first, after a closer
/// look at each.
std::vector<SurfacePlace> find_worst(const ComparedSurface& surface, std::span<const Measure> measures,
                                     std::size_t m, const Integrals& integrals,
                                     std::vector<float>& triangle_worst) {
  std::vector<std::uint32_t> order(surface.n_triangles());
  std::iota(order.begin(), order.end(), 0U);
  const std::size_t n_worst = std::min<std::size_t>(8, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(n_worst), order.end(),
                    [&](std::uint32_t a, std::uint32_t b) {
                      const float of_a = std::abs(triangle_worst[a]), of_b = std::abs(triangle_worst[b]);
                      return of_a != of_b ? of_a > of_b : a < b;
                    });
  std::vector<SurfacePlace> places(n_worst);
  parallel_blocks(n_worst, 1, [&](std::size_t i, std::size_t) {
    const std::uint32_t f = order[i];
    if (area_of(surface.patch(f)) == 0) return;
    const TriangleError error(surface, f, measures.subspan(m, 1));
    Sums sums = look_at(error).sums[0];
    // In float, as it was recorded.
    if (static_cast<float>(sums.max) < std::abs(triangle_worst[f]))
      sums = sums_of(surface, measures, integrals, f)[m];
    climb(error, sums);
    triangle_worst[f] = static_cast<float>(sums.worst);
    places[i] = {.triangle = f,
                 .source_face = surface.mesh().source_face_of(f),
                 .barycentrics = sums.max_at,
                 .position = surface.patch(f).positions * sums.max_at,
                 .error = sums.max,
                 .light = error.worst_light(sums.max_at)};
  });
  std::erase_if(places, [](const SurfacePlace& place) { return !(place.error > 0); });
  std::sort(places.begin(), places.end(), [](const SurfacePlace& a, const SurfacePlace& b) {
    return a.error != b.error ? a.error > b.error : a.triangle < b.triangle;
  });
  return places;
}

/// Fills in all but triangle_worst, which gets a closer look where it is largest.
void summarise(const ComparedSurface& surface, std::span<const Measure> measures, std::size_t m,
               const Integrals& integrals, SurfaceError& error) {
  error.worst = find_worst(surface, measures, m, integrals, error.triangle_worst);
  const Totals totals = total_of(integrals);
  error.max_sampled = std::max(totals.max[m], error.worst.empty() ? 0 : error.worst.front().error);
  error.area = totals.area;
  if (!(totals.area > 0)) return;
  error.rmse = std::sqrt(totals.square[m] / totals.area);
  error.mae = totals.absolute[m] / totals.area;
  error.mean = totals.plain[m] / totals.area;
}

}  // namespace

SurfaceError surface_error(const Scene& scene, const BakedColors& baked, ErrorSpace space) {
  const ComparedSurface surface(scene, baked);
  const std::array<Measure, 1> measures = {{{baked.colors, space}}};
  SurfaceError result;
  const Integrals integrals = integrate_surface(surface, measures, std::array{&result.triangle_worst});
  summarise(surface, measures, 0, integrals, result);
  return result;
}

SurfaceErrors surface_errors(const Scene& scene, const BakedColors& baked,
                             const std::vector<LinearRgb>& computed) {
  const ComparedSurface surface(scene, baked);
  if (computed.size() != baked.colors.size())
    throw InvalidScene(fmt::format("measure: computed colours: expected {}, found {}", baked.colors.size(),
                                   computed.size()));
  const std::array<Measure, 3> all = {{{baked.colors, ErrorSpace::linear},
                                       {baked.colors, ErrorSpace::display},
                                       {computed, ErrorSpace::linear}}};
  const std::span<const Measure> measures = std::span(all).first(computed == baked.colors ? 2 : 3);
  SurfaceErrors result;
  const Integrals integrals = integrate_surface(
      surface, measures, std::array{&result.linear.triangle_worst, &result.display.triangle_worst});
  summarise(surface, measures, 0, integrals, result.linear);
  summarise(surface, measures, 1, integrals, result.display);
  result.computed_rmse = result.linear.rmse;
  if (const Totals totals = total_of(integrals); measures.size() == 3 && totals.area > 0)
    result.computed_rmse = std::sqrt(totals.square[2] / totals.area);
  return result;
}

}  // namespace lambake
