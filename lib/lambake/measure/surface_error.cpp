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
#include "lambake/measure/surface.h"
#include "lambake/measure/triangle_error.h"

namespace lambake {
namespace {

/// Area integrals over a group of triangles.
struct Totals {
  double area = 0;
  PerMeasure<double> square{}, absolute{}, plain{};
  PerMeasure<double> max{};           ///< The largest |e| that was met.
  PerMeasure<double> n_with_error{};  ///< Triangles.

  void add(const PerMeasure<ErrorSums>& sums, double weight) {
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
PerMeasure<ErrorSums> sums_of(const ComparedSurface& surface, std::span<const ErrorMeasure> measures,
                              const Integrals& integrals, std::size_t f) {
  if (area_of(surface.patch(f)) == 0) return {};
  const TriangleError error(surface, f, measures);
  const PerMeasure<ErrorSums> rough = look_at(error).sums;
  if (!is_open(surface, integrals, f)) return rough;
  PerMeasure<ErrorSums> sums = integrate_triangle(error, integrals.tolerances(surface, f));
  for (std::size_t m = 0; m < measures.size(); ++m) sums[m].see(rough[m]);
  return sums;
}

/// @param worst  for each of the first measures F' floats, which are set to the worst difference of each
/// triangle.
Integrals integrate_surface(const ComparedSurface& surface, std::span<const ErrorMeasure> measures,
                            std::span<std::vector<float>* const> worst) {
  const std::size_t n = surface.n_triangles();
  Integrals result;
  result.groups.resize((n + group_size - 1) / group_size);
  result.uncertainties.resize(n);
  for (auto* values : {&result.allowed, &result.allowed_noise})
    values->fill(std::numeric_limits<double>::infinity());
  for (std::vector<float>* values : worst) values->assign(n, 0);
  const auto take = [&](std::size_t f, const PerMeasure<ErrorSums>& sums) {
    result.groups[f / group_size].add(sums, area_of(surface.patch(f)));
    for (std::size_t m = 0; m < worst.size(); ++m) (*worst[m])[f] = static_cast<float>(sums[m].worst);
  };
  parallel_blocks(n, groups_in_block * group_size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      if (area_of(surface.patch(f)) == 0) continue;
      const ErrorEstimate total = look_at(TriangleError(surface, f, measures));
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
std::vector<SurfacePlace> find_worst(const ComparedSurface& surface, std::span<const ErrorMeasure> measures,
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
    ErrorSums sums = look_at(error).sums[0];
    // In float, as it was recorded.
    if (static_cast<float>(sums.max) < std::abs(triangle_worst[f]))
      sums = sums_of(surface, measures, integrals, f)[m];
    climb_to_largest(error, sums);
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
void summarise(const ComparedSurface& surface, std::span<const ErrorMeasure> measures, std::size_t m,
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
  const std::array<ErrorMeasure, 1> measures = {{{baked.colors, space, true}}};
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
  const std::array<ErrorMeasure, 3> all = {{{baked.colors, ErrorSpace::linear, true},
                                            {baked.colors, ErrorSpace::display, true},
                                            {computed, ErrorSpace::linear, false}}};
  const std::span<const ErrorMeasure> measures =
      std::span(all).first(computed == baked.colors && baked.hidden_emission.empty() ? 2 : 3);
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
