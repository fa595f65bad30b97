#include "lambake/geometry/triangulate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

namespace lambake {
namespace {

using Point = glm::dvec2;

double cross(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Newell's normal, about the first corner so that far-off coordinates do not cancel.
glm::dvec3 newell_normal(std::span<const glm::vec3> positions, std::span<const std::uint32_t> polygon) {
  const glm::dvec3 origin(positions[polygon[0]]);
  glm::dvec3 normal(0);
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    normal += glm::cross(glm::dvec3(positions[polygon[i]]) - origin,
                         glm::dvec3(positions[polygon[i + 1]]) - origin);
  return normal;
}

/// The polygon in the coordinate plane most across its normal, counter-clockwise.
std::vector<Point> project(std::span<const glm::vec3> positions, std::span<const std::uint32_t> polygon,
                           const glm::dvec3& normal) {
  const glm::dvec3 size = glm::abs(normal);
  const int drop = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  int u = (drop + 1) % 3, v = (drop + 2) % 3;
  if (normal[drop] < 0) std::swap(u, v);
  std::vector<Point> points;
  points.reserve(polygon.size());
  for (const std::uint32_t i : polygon) points.emplace_back(positions[i][u], positions[i][v]);
  return points;
}

void append_fan(std::span<const std::uint32_t> polygon, std::vector<glm::uvec3>& triangles) {
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    triangles.emplace_back(polygon[0], polygon[i], polygon[i + 1]);
}

void append_quad(std::span<const glm::vec3> positions, std::span<const std::uint32_t> q,
                 std::span<const Point> p, std::vector<glm::uvec3>& triangles) {
  // A diagonal is inside if the other two corners lie on its two sides.
  const bool is_02_inside = cross(p[0], p[1], p[2]) > 0 && cross(p[0], p[2], p[3]) > 0;
  const bool is_13_inside = cross(p[1], p[2], p[3]) > 0 && cross(p[1], p[3], p[0]) > 0;
  const glm::dvec3 d02 = glm::dvec3(positions[q[2]]) - glm::dvec3(positions[q[0]]);
  const glm::dvec3 d13 = glm::dvec3(positions[q[3]]) - glm::dvec3(positions[q[1]]);
  const bool is_02 = is_02_inside != is_13_inside ? is_02_inside : glm::dot(d02, d02) <= glm::dot(d13, d13);
  if (is_02) {
    triangles.emplace_back(q[0], q[1], q[2]);
    triangles.emplace_back(q[0], q[2], q[3]);
  } else {
    triangles.emplace_back(q[1], q[2], q[3]);
    triangles.emplace_back(q[1], q[3], q[0]);
  }
}

/// Clips ears off a counter-clockwise polygon.
class EarClipper {
 public:
  EarClipper(std::span<const std::uint32_t> polygon, std::span<const Point> points)
      : polygon_(polygon), points_(points), next_(points.size()), previous_(points.size()) {
    const std::size_t n = points.size();
    for (std::size_t i = 0; i < n; ++i) next_[i] = (i + 1) % n, previous_[i] = (i + n - 1) % n;
    for (std::size_t i = 0; i < n; ++i)
      if (turn(i) <= 0) reflex_.push_back(i);
  }

  /// False if corners had to be clipped that are no ears: the polygon crosses itself or is too intricate.
  bool clip(std::vector<glm::uvec3>& triangles) {
    std::size_t n_left = points_.size();
    std::size_t at = 0;
    bool is_clean = true;
    steps_left_ = 4000 * n_left + 1'000'000;
    // Moves on to the first corner that will do; false if none does.
    const auto find = [&](auto&& will_do) {
      for (std::size_t n_tried = 0; n_tried < n_left && steps_left_ > 0; ++n_tried, at = next_[at]) {
        if (will_do(at)) return true;
        if (steps_left_ > 0) --steps_left_;
      }
      return false;
    };
    while (n_left > 3) {
      if (steps_left_ == 0) {
        append_rest_as_fan(at, n_left, triangles);
        return false;
      }
      // Only straight corners may be left beside reflex ones: clipping one opens the way.
      if (!find([this](std::size_t i) { return is_ear(i); }) &&
          !find([this](std::size_t i) { return turn(i) == 0; })) {
        is_clean = false;
        find([this](std::size_t i) { return turn(i) > 0; });
      }
      append(at, triangles);
      next_[previous_[at]] = next_[at];
      previous_[next_[at]] = previous_[at];
      --n_left;
      at = next_[next_[at]];  // Skipping one keeps the triangles from gathering at one corner.
    }
    append(at, triangles);
    return is_clean;
  }

 private:
  void append_rest_as_fan(std::size_t apex, std::size_t n_left, std::vector<glm::uvec3>& triangles) const {
    std::size_t b = next_[apex];
    for (; n_left > 2; --n_left, b = next_[b])
      triangles.emplace_back(polygon_[apex], polygon_[b], polygon_[next_[b]]);
  }
  double turn(std::size_t i) const { return cross(points_[previous_[i]], points_[i], points_[next_[i]]); }

  bool is_ear(std::size_t i) {
    if (!(turn(i) > 0)) return false;
    const Point &a = points_[previous_[i]], &b = points_[i], &c = points_[next_[i]];
    for (std::size_t k = 0; k < reflex_.size() && steps_left_ > 0; --steps_left_) {
      const std::size_t r = reflex_[k];
      // Clipped, or convex by now: such a corner cannot be the first inside of an ear.
      if (next_[previous_[r]] != r || turn(r) > 0) {
        reflex_[k] = reflex_.back();
        reflex_.pop_back();
        continue;
      }
      ++k;
      const Point& p = points_[r];
      if (p == a || p == b || p == c) continue;  // The ends, or another corner at the same point.
      if (cross(a, b, p) >= 0 && cross(b, c, p) >= 0 && cross(c, a, p) >= 0) return false;
    }
    return true;
  }

  void append(std::size_t i, std::vector<glm::uvec3>& triangles) const {
    triangles.emplace_back(polygon_[previous_[i]], polygon_[i], polygon_[next_[i]]);
  }

  std::span<const std::uint32_t> polygon_;
  std::span<const Point> points_;
  std::vector<std::size_t> next_, previous_;
  std::vector<std::size_t> reflex_;
  std::size_t steps_left_ = 0;
};

/// Cuts the quadrilateral abcd of abc at `first` and acd behind it along bd, if that leaves both wound as it
/// is.
bool turn_diagonal(std::span<const glm::vec3> positions, std::span<glm::uvec3> triangles, std::size_t first) {
  const std::uint32_t a = triangles[first].x, b = triangles[first].y, c = triangles[first].z,
                      d = triangles[first + 1].z;
  const glm::dvec3 pb(positions[b]), bd = glm::dvec3(positions[d]) - pb;
  const glm::dvec3 bcd = glm::cross(glm::dvec3(positions[c]) - pb, bd),
                   bda = glm::cross(bd, glm::dvec3(positions[a]) - pb);
  if (!(glm::dot(bcd, bda) > 0)) return false;
  triangles[first] = {b, c, d};
  triangles[first + 1] = {b, d, a};
  return true;
}

/// The cosine between the normals of the triangle at `first` and of the one behind it; 0 where one has none.
double flatness(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                std::size_t first) {
  const auto normal = [&](const glm::uvec3& t) {
    const glm::dvec3 p(positions[t.x]);
    return glm::cross(glm::dvec3(positions[t.y]) - p, glm::dvec3(positions[t.z]) - p);
  };
  const glm::dvec3 one = normal(triangles[first]), two = normal(triangles[first + 1]);
  const double size = glm::length(one) * glm::length(two);
  return size > 0 ? glm::dot(one, two) / size : 0;
}

std::array<std::uint32_t, 3> sorted_corners(const glm::uvec3& t) {
  std::array<std::uint32_t, 3> corners{t.x, t.y, t.z};
  std::sort(corners.begin(), corners.end());
  return corners;
}

}  // namespace

void part_folded_quads(std::span<const glm::vec3> positions, std::span<const std::uint32_t> faces,
                       std::span<glm::uvec3> triangles) {
  std::vector<std::uint8_t> n_triangles(positions.size(), 0);  // At a vertex, up to 3.
  for (const glm::uvec3& t : triangles)
    for (int c = 0; c < 3; ++c) n_triangles[t[c]] = std::min(3, n_triangles[t[c]] + 1);
  // The first triangle of the quadrilateral that has this one, or none.
  constexpr auto none = static_cast<std::size_t>(-1);
  const auto quad_of = [&](std::size_t f) {
    const auto is_same = [&](std::size_t g) { return g < faces.size() && faces[g] == faces[f]; };
    if (is_same(f + 1) && !is_same(f + 2) && !is_same(f - 1)) return f;
    return is_same(f - 1) && !is_same(f - 2) && !is_same(f + 1) ? f - 1 : none;
  };
  std::map<std::uint32_t, std::size_t> first_at;
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    const std::size_t quad = quad_of(f);
    if (quad == none) continue;
    const glm::uvec3& partner = triangles[2 * quad + 1 - f];
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t v = triangles[f][c];
      if (n_triangles[v] != 2 || glm::any(glm::equal(partner, glm::uvec3(v)))) continue;
      const auto [other, is_first] = first_at.try_emplace(v, f);
      if (is_first || faces[other->second] == faces[f] ||
          sorted_corners(triangles[other->second]) != sorted_corners(triangles[f]))
        continue;
      std::size_t one = quad, two = quad_of(other->second);
      if (flatness(positions, triangles, two) < flatness(positions, triangles, one)) std::swap(one, two);
      if (!turn_diagonal(positions, triangles, one)) turn_diagonal(positions, triangles, two);
      break;
    }
  }
}

bool triangulate_polygon(std::span<const glm::vec3> positions, std::span<const std::uint32_t> corners,
                         std::vector<glm::uvec3>& triangles) {
  std::vector<std::uint32_t> polygon;
  polygon.reserve(corners.size());
  for (const std::uint32_t v : corners)
    if (polygon.empty() || v != polygon.back()) polygon.push_back(v);
  while (polygon.size() > 1 && polygon.front() == polygon.back()) polygon.pop_back();
  if (polygon.size() < 3) {
    triangles.emplace_back(corners[0], corners[1], corners[2]);
    return true;
  }
  if (polygon.size() == 3) {
    triangles.emplace_back(polygon[0], polygon[1], polygon[2]);
    return true;
  }
  const glm::dvec3 normal = newell_normal(positions, polygon);
  const double size = glm::length(normal);
  if (!std::isfinite(size) || size == 0) {
    append_fan(polygon, triangles);
    return false;
  }
  const std::vector<Point> points = project(positions, polygon, normal);
  if (polygon.size() == 4) {
    append_quad(positions, polygon, points, triangles);
    return true;
  }
  return EarClipper(polygon, points).clip(triangles);
}

}  // namespace lambake
