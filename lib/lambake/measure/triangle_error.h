#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "lambake/measure/surface.h"

/// The error on one triangle: where it is looked at, and its integrals. Internal to surface_error().
namespace lambake {

/// Mean values over (a part of) a triangle, and the largest that was met in its three channels.
struct ErrorSums {
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
  void add(const ErrorSums& other, double weight) {
    square += weight * other.square;
    absolute += weight * other.absolute;
    plain += weight * other.plain;
    see(other);
  }
  void see(const ErrorSums& other) {
    if (other.max >= 0) see(other.worst, other.max_at);
  }
};

/// What is compared with per-pixel lighting: colours of the vertices, and the space.
struct ErrorMeasure {
  const std::vector<LinearRgb>& colors;
  ErrorSpace space;
  bool hides_emission;  ///< Where the baked colours do.
};

/// One value for each of the measures of a pass.
constexpr std::size_t most_measures = 3;
template <typename T>
using PerMeasure = std::array<T, most_measures>;

/// G − F on one triangle, of all measures: F, which is what costs, is evaluated once.
class TriangleError {
 public:
  /// The arguments must outlive it.
  TriangleError(const ComparedSurface& surface, std::size_t triangle, std::span<const ErrorMeasure> measures);

  std::size_t n_measures() const { return measures_.size(); }
  PerMeasure<glm::dvec3> operator()(const glm::dvec3& b) const;

  /// The triangle cut at terminators, and quartered where light is narrow (shading/patch_parts.h). Where few
  /// triangles have all of a texture between them, each is quartered for that too.
  std::vector<glm::dmat3> parts() const;

  /// The light whose share of the error at `b` is the largest; none where no light reaches the triangle.
  std::optional<std::uint32_t> worst_light(const glm::dvec3& b) const;

 private:
  const ComparedSurface& surface_;
  std::size_t triangle_;
  std::span<const ErrorMeasure> measures_;
  Patch patch_;
  PerMeasure<glm::dmat3> colors_;  ///< Column i at corner i.
  bool has_texture_, hides_emission_;
  Finish finish_;
  std::vector<std::uint32_t> lights_;
};

/// Means over (a part of) a triangle by the rule of degree 5, and how far those of degree 4 are from them in
/// Σ e².
struct ErrorEstimate {
  PerMeasure<ErrorSums> sums;
  PerMeasure<double> uncertainties{};

  void add(const ErrorEstimate& other, double weight, std::size_t n_measures) {
    for (std::size_t m = 0; m < n_measures; ++m) {
      sums[m].add(other.sums[m], weight);
      uncertainties[m] += weight * other.uncertainties[m];
    }
  }
};

/// The first look at a triangle: its parts by their rules, and where the largest errors lie.
ErrorEstimate look_at(const TriangleError& error);

/// Adaptive quadrature of one triangle: of n parts the most urgent one is quartered until none is above
/// 1/√n. What is left has either sign and adds up as its squares do, to the tolerance of each measure.
PerMeasure<ErrorSums> integrate_triangle(const TriangleError& error, const PerMeasure<double>& tolerances);

/// The largest error on the triangle, of the only measure: the best of a dense grid, then of ever smaller
/// ones around it.
void climb_to_largest(const TriangleError& error, ErrorSums& sums);

}  // namespace lambake
