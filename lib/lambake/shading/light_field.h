#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace lambake {

/// Lights of falloff 1/d² as one array per number. The arrays are `lane_padding` longer than `size`, so that
/// vectors may run over the end.
struct LightArrays {
  static constexpr std::size_t lane_padding = 16;
  std::vector<float> x, y, z, r, g, b;
  std::vector<std::uint32_t> index;  ///< Which light of the caller's.
  std::size_t size = 0;

  void reserve(std::size_t n);  ///< Room for n lights (and the padding); keeps none.
};

/// Points with unit normals as one array per number, N each, padded like LightArrays, and what they receive.
struct PointArrays {
  std::vector<float> x, y, z, nx, ny, nz;
  std::vector<float> r, g, b;  ///< Received light, added to.

  void resize(std::size_t n);
};

/// The light that far lamps of falloff 1/d² throw into a ball, while no point in it turns away from them.
///
/// Without the clamp, E(p, n) = n·∇Φ(p) with the Coulomb potential Φ(p) = Σ I_i/|x_i − p|, a harmonic
/// function: the field is kept as the spherical harmonics of Φ around the centre up to `order`, one set a
/// channel. The cost of a point does not depend on the number of lights. Source: Greengard & Rokhlin 1987
/// (local expansion); recurrences as in Wang & LeSar 1996.
struct LightField {
  static constexpr int order = 6;
  static constexpr int n_coefficients = (order + 1) * (order + 1);
  glm::vec3 center{0};
  float radius = 1;  ///< Unit of length of the expansion; > 0.
  std::array<std::array<double, n_coefficients>, 3>
      coefficients{};    ///< By channel, then as in harmonic_index().
  bool is_empty = true;  ///< No light is in it: the coefficients are 0.

  /// l in [0, order], m in [0, l]; the imaginary part (m > 0) follows the real one.
  static constexpr int harmonic_index(int l, int m) { return m == 0 ? l * l : l * l + 2 * m - 1; }
  /// |error| of the order-th expansion is at most this, times I/d², for a light at distance d of a ball of
  /// radius q·d, 0 <= q < 1.
  ///
  /// The l-th term of Φ, |t|^l P_l(cos γ)/d^(l+1), has a gradient of at most sqrt(l(l+1)) |t|^(l−1)/d^(l+1)
  /// (P² + (1−x²)P'²/(l(l+1)) <= 1, Szegő 7.3), so the rest is below Σ_{l>order} (l + ½) q^(l−1).
  template <typename Real>
  static constexpr Real remainder(Real q) {
    Real power = 1;
    for (int l = 0; l < order; ++l) power *= q;
    return (Real(order) + Real(1.5)) * power / ((Real(1) - q) * (Real(1) - q));
  }
};

/// Adds all `lights`, none of them inside the ball, to the field; what is in their padding must be finite and
/// black. The sum has the same bits on every vector path.
void add_lights(LightField& field, const LightArrays& lights);

/// Replaces the coefficients of each field of `to`, whose ball lies within that of `from`, by the field
/// `from`: the expansion is a polynomial, so this is exact but for the rounding. The same bits on every
/// vector path.
void translate(const LightField& from, std::span<LightField> to);

/// Adds the field's light at points [begin, end); begin is a multiple of 16, end as well or the number of
/// points.
void add_irradiance(const LightField& field, PointArrays& points, std::size_t begin, std::size_t end);

}  // namespace lambake
