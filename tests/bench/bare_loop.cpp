#include "bare_loop.h"

#include <cmath>

void bare_loop(std::array<const float*, 3> positions, std::array<const float*, 3> normals,
               std::array<float*, 3> out, std::size_t n, const float* lights, std::size_t n_lights) {
  const float* __restrict px = positions[0];
  const float* __restrict py = positions[1];
  const float* __restrict pz = positions[2];
  const float* __restrict nx = normals[0];
  const float* __restrict ny = normals[1];
  const float* __restrict nz = normals[2];
  constexpr std::size_t width = 16;
  for (std::size_t i = 0; i + width <= n; i += width) {
    float r[width] = {}, g[width] = {}, b[width] = {};
    for (std::size_t l = 0; l < n_lights; ++l) {
      const float* light = lights + 6 * l;
      for (std::size_t k = 0; k < width; ++k) {
        const float x = light[0] - px[i + k], y = light[1] - py[i + k], z = light[2] - pz[i + k];
        const float d2 = x * x + y * y + z * z;
        const float facing = nx[i + k] * x + ny[i + k] * y + nz[i + k] * z;
        const float value = facing / std::sqrt(d2) * (1.0f / d2);
        const float lit = facing > 0 ? value : 0.0f;
        r[k] += light[3] * lit;
        g[k] += light[4] * lit;
        b[k] += light[5] * lit;
      }
    }
    for (std::size_t k = 0; k < width; ++k) out[0][i + k] = r[k], out[1][i + k] = g[k], out[2][i + k] = b[k];
  }
}
