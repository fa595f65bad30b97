#include "lambake/measure/surface_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "lambake/core/parallel.h"
#include "lambake/core/quadrature.h"
#include "lambake/measure/surface.h"

namespace lambake {
namespace {

constexpr std::size_t block_size = 256;

/// Mean values over (a part of) a triangle, over its three channels, and the largest that was met.
struct Sums {
  double square = 0, absolute = 0, plain = 0;
  double max = -1;   ///< |worst|; below 0 where nothing was seen.
  double worst = 0;  ///< Signed, of the worst channel.
  glm::dvec3 max_at{1, 0, 0};

  void see(double error, const glm::dvec3& b) {
    if (std::abs(error) > max) max = std::abs(error), worst = error, max_at = b;
  }
  void see(const glm::dvec3& e, const glm::dvec3& b) {
    for (int c = 0; c < 3; ++c) see(e[c], b);
  }
  void add(const glm::dvec3& e, double weight, const glm::dvec3& b) {
    square += weight * glm::dot(e, e) / 3;
    absolute += weight * (std::abs(e[0]) + std::abs(e[1]) + std::abs(e[2])) / 3;
    plain += weight * (e[0] + e[1] + e[2]) / 3;
    see(e, b);
  }
  void add(const Sums& other, double weight) {
    square += weight * other.square;
    absolute += weight * other.absolute;
    plain += weight * other.plain;
    if (other.max >= 0) see(other.worst, other.max_at);
  }
};

/// G − F on one triangle.
class TriangleError {
 public:
  TriangleError(const ComparedSurface& surface, std::size_t triangle, ErrorSpace space)
      : surface_(surface),
        triangle_(triangle),
        space_(space),
        patch_(surface.patch(triangle)),
        has_texture_(surface.has_texture(triangle)),
        finish_(surface.finish_at(triangle, glm::dvec3(1.0 / 3))) {
    if (!finish_.is_unlit) find_reaching_lights(surface.scene().lights, patch_, lights_);
  }

  glm::dvec3 operator()(const glm::dvec3& b) const {
    const Finish finish = has_texture_ ? surface_.finish_at(triangle_, b) : finish_;
    const glm::dvec3 f = reference_at(patch_, surface_.scene().lights, lights_, finish.is_unlit, b);
    const glm::dvec3 g = patch_.colors * b;
    if (space_ == ErrorSpace::linear) return finish.base * (g - f);
    return compared(finish.emission + finish.base * g, space_) -
           compared(finish.emission + finish.base * f, space_);
  }

  /// The triangle cut along the terminators of its lights (their chords, where they are curves), as long as
  /// that makes at most `max_parts`: there the error has its kinks.
  std::vector<glm::dmat3> parts(std::size_t max_parts) const {
    std::vector<glm::dmat3> parts{glm::dmat3(1.0)}, next;
    for (const std::uint32_t light : lights_) {
      next.clear();
      for (const glm::dmat3& part : parts)
        cut_at_terminator(surface_.scene().lights[light], patch_, part, next);
      if (next.size() > max_parts) break;
      parts.swap(next);
    }
    return parts;
  }

  /// The light whose share of the error at `b` is the largest.
  std::uint32_t worst_light(const glm::dvec3& b) const {
    double worst = -1;
    std::uint32_t light = 0;
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

  const Patch& patch() const { return patch_; }

 private:
  const ComparedSurface& surface_;
  std::size_t triangle_;
  ErrorSpace space_;
  Patch patch_;
  bool has_texture_;
  Finish finish_;
  std::vector<std::uint32_t> lights_;
};

double share_of_area(const glm::dmat3& part) {
  return std::abs(glm::determinant(part));
}

/// Mean over a part by the rule of degree 5, and how far that of degree 4 is from it in Σ e².
struct Estimate {
  Sums sums;
  double uncertainty = 0;
};

Estimate estimate(const TriangleError& error, const glm::dmat3& part) {
  Estimate result;
  double square_4 = 0;
  for (const QuadratureNode& node : quadrature_4) {
    const glm::dvec3 b = part * node.b, e = error(b);
    square_4 += node.weight * glm::dot(e, e) / 3;
    result.sums.see(e, b);
  }
  for (const QuadratureNode& node : quadrature_5) {
    const glm::dvec3 b = part * node.b;
    result.sums.add(error(b), node.weight, b);
  }
  // Corners and the middles of sides, where the largest errors lie, have no weight.
  for (int c = 0; c < 3; ++c)
    for (const glm::dvec3& b : {part[c], 0.5 * (part[c] + part[(c + 1) % 3])})
      result.sums.add(error(b), 0, b);
  result.uncertainty = std::abs(result.sums.square - square_4);
  return result;
}

/// Adaptive quadrature of one triangle: a part is quartered until its two rules agree to `tolerance`, which
/// halves from level to level as the number of parts along a kink doubles.
Sums integrate(const TriangleError& error, double tolerance) {
  constexpr int max_depth = 14;
  constexpr int max_estimates = 20000;
  struct Task {
    glm::dmat3 part;
    int depth;
  };
  std::vector<Task> tasks;
  for (const glm::dmat3& part : error.parts(32)) tasks.push_back({part, 0});
  Sums total;
  for (int n = 0; !tasks.empty(); ++n) {
    const Task task = tasks.back();
    tasks.pop_back();
    const Estimate e = estimate(error, task.part);
    const double share = share_of_area(task.part);
    if (e.uncertainty * share <= std::ldexp(tolerance, -task.depth) || task.depth == max_depth ||
        n > max_estimates) {
      total.add(e.sums, share);
      continue;
    }
    for (const glm::dmat3& quarter : quarters(task.part)) tasks.push_back({quarter, task.depth + 1});
  }
  return total;
}

/// The largest error on the triangle: the best of a dense grid, then of ever smaller ones around it.
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
        sums.see(error(b), b);
      }
    center = sums.max_at;
  }
}

}  // namespace

SurfaceError surface_error(const Scene& scene, const BakedColors& baked, ErrorSpace space) {
  const ComparedSurface surface(scene, baked);
  const std::size_t n = surface.n_triangles();
  std::vector<Sums> sums(n);
  std::vector<double> areas(n), uncertainties(n, 0.0);
  parallel_blocks(n, block_size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const Patch patch = surface.patch(f);
      const double area = area_of(patch);
      if (area == 0) continue;
      areas[f] = area;
      const TriangleError error(surface, f, space);
      for (const glm::dmat3& part : error.parts(32)) {
        const Estimate e = estimate(error, part);
        sums[f].add(e.sums, share_of_area(part));
        uncertainties[f] += e.uncertainty * share_of_area(part);
      }
    }
  });

  // Each triangle may be wrong by its equal part of 4e-4 of the whole: the RMSE by half of that. The whole is
  // known only roughly at first, so this is done again where it turns out smaller.
  double previous_total = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 4; ++round) {
    double total = 0;
    std::size_t n_with_error = 0;
    for (std::size_t f = 0; f < n; ++f) {
      total += areas[f] * sums[f].square;
      n_with_error += areas[f] * sums[f].square > 0;
    }
    if (!(total < 0.9 * previous_total)) break;
    previous_total = total;
    const double allowed = 4e-4 * total / static_cast<double>(std::max<std::size_t>(1, n_with_error));
    parallel_blocks(n, block_size, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f)
        if (areas[f] > 0 && areas[f] * uncertainties[f] > allowed)
          sums[f] = integrate(TriangleError(surface, f, space), allowed / areas[f]);
    });
  }

  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0U);
  const std::size_t n_worst = std::min<std::size_t>(8, n);
  const auto is_worse = [&](std::uint32_t a, std::uint32_t b) {
    return sums[a].max != sums[b].max ? sums[a].max > sums[b].max : a < b;
  };
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(n_worst), order.end(),
                    is_worse);
  parallel_blocks(n_worst, 1, [&](std::size_t i, std::size_t) {
    if (areas[order[i]] > 0) climb(TriangleError(surface, order[i], space), sums[order[i]]);
  });
  std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(n_worst), is_worse);

  SurfaceError result;
  result.triangle_rmse.resize(n);
  result.triangle_max.resize(n);
  result.triangle_worst.resize(n);
  double square = 0, absolute = 0, plain = 0;
  for (std::size_t f = 0; f < n; ++f) {
    result.area += areas[f];
    square += areas[f] * sums[f].square;
    absolute += areas[f] * sums[f].absolute;
    plain += areas[f] * sums[f].plain;
    result.triangle_rmse[f] = static_cast<float>(std::sqrt(sums[f].square));
    result.triangle_max[f] = static_cast<float>(std::max(0.0, sums[f].max));
    result.triangle_worst[f] = static_cast<float>(sums[f].worst);
    result.max_sampled = std::max(result.max_sampled, sums[f].max);
  }
  if (result.area > 0) {
    result.rmse = std::sqrt(square / result.area);
    result.mae = absolute / result.area;
    result.mean = plain / result.area;
  }
  for (std::size_t i = 0; i < n_worst && sums[order[i]].max > 0; ++i) {
    const std::uint32_t f = order[i];
    const TriangleError error(surface, f, space);
    SurfacePlace place;
    place.triangle = f;
    place.source_face = surface.mesh().source_face_of(f);
    place.barycentrics = sums[f].max_at;
    place.position = error.patch().positions * sums[f].max_at;
    place.error = sums[f].max;
    place.light = error.worst_light(sums[f].max_at);
    result.worst.push_back(place);
  }
  return result;
}

}  // namespace lambake
