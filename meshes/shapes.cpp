#include "shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace lambake {
namespace {

constexpr double pi = std::numbers::pi;

/// Two triangles for the quad a b c d, counter-clockwise, cut from a to c.
void add_quad(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  mesh.triangles.emplace_back(a, b, c);
  mesh.triangles.emplace_back(a, c, d);
}

/// A colour wheel of soft colours; `turn` in [0,1).
LinearRgb wheel_color(double turn) {
  const auto channel = [&](double offset) {
    return static_cast<float>(0.55 + 0.35 * std::cos(2 * pi * (turn - offset)));
  };
  return {channel(0), channel(1.0 / 3), channel(2.0 / 3)};
}

}  // namespace

Mesh icosphere(unsigned level) {
  const double g = std::numbers::phi;
  std::vector<glm::dvec3> points = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                    {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                    {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  for (glm::dvec3& p : points) p = glm::normalize(p);
  Mesh mesh;
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (unsigned l = 0; l < level; ++l) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> midpoints;
    const auto midpoint = [&](std::uint32_t a, std::uint32_t b) {
      const auto [it, is_new] = midpoints.try_emplace(std::minmax(a, b), points.size());
      if (is_new) points.push_back(glm::normalize(points[a] + points[b]));
      return it->second;
    };
    std::vector<glm::uvec3> finer;
    finer.reserve(4 * mesh.triangles.size());
    for (const glm::uvec3& t : mesh.triangles) {
      const std::uint32_t ab = midpoint(t.x, t.y), bc = midpoint(t.y, t.z), ca = midpoint(t.z, t.x);
      for (const glm::uvec3& part : {glm::uvec3(t.x, ab, ca), glm::uvec3(t.y, bc, ab),
                                     glm::uvec3(t.z, ca, bc), glm::uvec3(ab, bc, ca)})
        finer.push_back(part);
    }
    mesh.triangles = std::move(finer);
  }
  mesh.positions.assign(points.begin(), points.end());
  return mesh;
}

Mesh uv_sphere(unsigned n_rings, unsigned n_segments) {
  Mesh mesh;
  mesh.positions.emplace_back(0, 1, 0);
  for (unsigned ring = 1; ring < n_rings; ++ring) {
    const double polar = pi * ring / n_rings;
    for (unsigned s = 0; s < n_segments; ++s) {
      const double around = 2 * pi * s / n_segments;
      mesh.positions.emplace_back(std::sin(polar) * std::cos(around), std::cos(polar),
                                  -std::sin(polar) * std::sin(around));
    }
  }
  mesh.positions.emplace_back(0, -1, 0);
  const std::uint32_t south = 1 + (n_rings - 1) * n_segments;
  for (unsigned s = 0; s < n_segments; ++s) {
    const std::uint32_t here = 1 + s, next = 1 + (s + 1) % n_segments;
    mesh.triangles.emplace_back(0, here, next);
    for (unsigned ring = 0; ring + 2 < n_rings; ++ring) {
      const std::uint32_t upper = ring * n_segments, lower = upper + n_segments;
      add_quad(mesh, upper + here, lower + here, lower + next, upper + next);
    }
    const std::uint32_t last = (n_rings - 2) * n_segments;
    mesh.triangles.emplace_back(south, last + next, last + here);
  }
  mesh.normals = mesh.positions;
  return mesh;
}

Mesh torus_knot(unsigned n_along, unsigned n_around, float tube_radius) {
  constexpr double p = 2, q = 3, major = 1, minor = 0.45;
  Mesh mesh;
  for (unsigned i = 0; i < n_along; ++i) {
    const double t = 2 * pi * i / n_along;
    const double ring = major + minor * std::cos(q * t);
    const glm::dvec3 center(ring * std::cos(p * t), minor * std::sin(q * t), -ring * std::sin(p * t));
    // The knot lies on a torus: the torus' normal is across the curve everywhere and closes on itself.
    const glm::dvec3 outwards(std::cos(q * t) * std::cos(p * t), std::sin(q * t),
                              -std::cos(q * t) * std::sin(p * t));
    const glm::dvec3 tangent = glm::normalize(
        glm::dvec3(-q * minor * std::sin(q * t) * std::cos(p * t) - p * ring * std::sin(p * t),
                   q * minor * std::cos(q * t),
                   q * minor * std::sin(q * t) * std::sin(p * t) - p * ring * std::cos(p * t)));
    const glm::dvec3 sideways = glm::cross(outwards, tangent);
    for (unsigned k = 0; k < n_around; ++k) {
      const double around = 2 * pi * k / n_around;
      const glm::dvec3 normal = std::cos(around) * outwards + std::sin(around) * sideways;
      mesh.normals.emplace_back(normal);
      mesh.positions.emplace_back(center + double(tube_radius) * normal);
      mesh.colors.push_back(wheel_color(double(i) / n_along));
    }
  }
  for (unsigned i = 0; i < n_along; ++i)
    for (unsigned k = 0; k < n_around; ++k) {
      const std::uint32_t here = i * n_around, next = (i + 1) % n_along * n_around;
      const std::uint32_t right = (k + 1) % n_around;
      add_quad(mesh, here + k, next + k, next + right, here + right);
    }
  return mesh;
}

Mesh cube(unsigned split) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.emplace_back((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
  constexpr std::uint32_t sides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (unsigned i = 0; i < 6; ++i) {
    const auto& [a, b, c, d] = sides[i];
    if ((split >> i & 1) == 0)
      add_quad(mesh, a, b, c, d);
    else
      add_quad(mesh, b, c, d, a);
  }
  return mesh;
}

Mesh rounded_box(unsigned n_arc) {
  constexpr double half_x = 1.2, half_y = 0.7, half_z = 0.8, radius = 0.3;
  Mesh mesh;
  for (int corner = 0; corner < 4; ++corner) {
    const double sign_x = corner == 0 || corner == 3 ? 1 : -1, sign_z = corner < 2 ? 1 : -1;
    for (unsigned i = 0; i <= n_arc; ++i) {
      const double angle = pi / 2 * (corner + double(i) / n_arc);
      const double x = sign_x * (half_x - radius) + radius * std::cos(angle);
      const double z = sign_z * (half_z - radius) + radius * std::sin(angle);
      mesh.positions.emplace_back(x, -half_y, -z);
      mesh.positions.emplace_back(x, half_y, -z);
    }
  }
  const auto n_rim = static_cast<std::uint32_t>(mesh.n_vertices());
  mesh.positions.emplace_back(0, -half_y, 0);
  mesh.positions.emplace_back(0, half_y, 0);
  for (std::uint32_t low = 0; low < n_rim; low += 2) {
    const std::uint32_t next = (low + 2) % n_rim;
    add_quad(mesh, low, next, next + 1, low + 1);
    mesh.triangles.emplace_back(n_rim, next, low);
    mesh.triangles.emplace_back(n_rim + 1, low + 1, next + 1);
  }
  return mesh;
}

Mesh grid(unsigned n, float half_side) {
  Mesh mesh;
  for (unsigned row = 0; row <= n; ++row)
    for (unsigned column = 0; column <= n; ++column) {
      const double u = double(column) / n, v = double(row) / n;
      mesh.positions.emplace_back(half_side * (2 * u - 1), 0, half_side * (2 * v - 1));
      mesh.texcoords[0].emplace_back(u, v);
    }
  for (unsigned row = 0; row < n; ++row)
    for (unsigned column = 0; column < n; ++column) {
      const std::uint32_t back = row * (n + 1) + column, front = back + n + 1;
      add_quad(mesh, back, front, front + 1, back + 1);
    }
  return mesh;
}

Mesh height_field(unsigned n) {
  Mesh mesh = grid(n, 1);
  for (glm::vec3& p : mesh.positions) {
    const double x = p.x, z = p.z;
    p.y = static_cast<float>(0.12 * std::sin(3.1 * x + 0.4) * std::cos(2.7 * z) +
                             0.06 * std::sin(5.3 * z - 2.1 * x) + 0.025 * std::cos(9.7 * x + 7.9 * z));
  }
  return mesh;
}

Mesh moebius_band(unsigned n) {
  constexpr double half_width = 0.3;
  Mesh mesh;
  for (unsigned i = 0; i < n; ++i) {
    const double around = 2 * pi * i / n;
    for (const double across : {-half_width, half_width}) {
      const double r = 1 + across * std::cos(around / 2);
      mesh.positions.emplace_back(r * std::cos(around), across * std::sin(around / 2), -r * std::sin(around));
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t low = 2 * i, high = 2 * i + 1;
    // After one turn the band's lower rim meets its upper one.
    const bool closes = i + 1 == n;
    const std::uint32_t next_low = closes ? 1 : low + 2, next_high = closes ? 0 : low + 3;
    add_quad(mesh, low, high, next_high, next_low);
  }
  return mesh;
}

}  // namespace lambake
