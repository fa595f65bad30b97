#pragma once

#include <array>
#include <glm/glm.hpp>

namespace lambake {

/// A node of a quadrature rule on a triangle: its barycentrics, and its weight. Weights add up to 1.
struct QuadratureNode {
  glm::dvec3 b;
  double weight;
};

namespace quadrature_detail {
constexpr void add_orbit(QuadratureNode* to, double a, double weight) {
  to[0] = {{1 - 2 * a, a, a}, weight};
  to[1] = {{a, 1 - 2 * a, a}, weight};
  to[2] = {{a, a, 1 - 2 * a}, weight};
}
}  // namespace quadrature_detail

/// Exact to degree 4 with 6 nodes; Dunavant, IJNME 21, 1985.
inline constexpr std::array<QuadratureNode, 6> quadrature_4 = [] {
  std::array<QuadratureNode, 6> rule{};
  quadrature_detail::add_orbit(rule.data(), 0.445948490915965, 0.223381589678011);
  quadrature_detail::add_orbit(&rule[3], 0.091576213509771, 0.109951743655322);
  return rule;
}();

/// Exact to degree 5 with 7 nodes; Radon 1948.
inline constexpr std::array<QuadratureNode, 7> quadrature_5 = [] {
  constexpr double sqrt15 = 3.872983346207417;
  std::array<QuadratureNode, 7> rule{};
  quadrature_detail::add_orbit(rule.data(), (6 - sqrt15) / 21, (155 - sqrt15) / 1200);
  quadrature_detail::add_orbit(&rule[3], (6 + sqrt15) / 21, (155 + sqrt15) / 1200);
  rule[6] = {{1.0 / 3, 1.0 / 3, 1.0 / 3}, 0.225};
  return rule;
}();

/// The four similar quarters of a triangle given by the barycentrics of its corners.
inline std::array<glm::dmat3, 4> quarters(const glm::dmat3& t) {
  const glm::dvec3 m01 = 0.5 * (t[0] + t[1]), m12 = 0.5 * (t[1] + t[2]), m20 = 0.5 * (t[2] + t[0]);
  return {glm::dmat3(t[0], m01, m20), glm::dmat3(m01, t[1], m12), glm::dmat3(m20, m12, t[2]),
          glm::dmat3(m01, m12, m20)};
}

}  // namespace lambake
