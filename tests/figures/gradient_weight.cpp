// Draws the figure of docs/methods.md that the default of --gradient-weight comes from.
//
//     draw_gradient_weight FILE.svg
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "figures/drawing.h"
#include "lambake/bake/bake.h"
#include "lambake/geometry/edges.h"
#include "lambake/measure/surface_error.h"
#include "measure/scenes.h"
#include "shapes.h"

namespace lambake {
namespace {

/// ∇c over a triangle, of the red channel.
glm::dvec3 gradient(const Mesh& mesh, const std::vector<LinearRgb>& colors, std::uint32_t f) {
  const glm::uvec3& t = mesh.triangles[f];
  const glm::dvec3 p[3] = {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
  const glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
  glm::dvec3 sum(0);
  for (int i = 0; i < 3; ++i)
    sum += double(colors[t[i]].r) * glm::cross(normal, p[(i + 2) % 3] - p[(i + 1) % 3]);
  return sum / glm::dot(normal, normal);
}

/// The jumps of the slope across the edges, root of the sum of squares weighted by length: what shows as
/// bands.
double slope_jump(const Mesh& mesh, const std::vector<LinearRgb>& colors) {
  double sum = 0;
  const std::vector<EdgeSide> sides = sorted_edge_sides(mesh);
  for_each_edge(std::span(sides), [&](std::span<const EdgeSide> edge) {
    if (edge.size() != 2) return;
    double jump = 0, length = 0;
    for (const EdgeSide& side : edge) {
      const glm::uvec3& t = mesh.triangles[side.corner / 3];
      const int k = static_cast<int>(side.corner % 3);
      const glm::dvec3 a = mesh.positions[t[k]], b = mesh.positions[t[(k + 1) % 3]];
      const glm::dvec3 normal = glm::cross(b - a, glm::dvec3(mesh.positions[t[(k + 2) % 3]]) - a);
      length = glm::length(b - a);
      jump += glm::dot(gradient(mesh, colors, side.corner / 3), glm::normalize(glm::cross(b - a, normal)));
    }
    sum += length * jump * jump;
  });
  return std::sqrt(sum);
}

struct Case {
  const char* name;
  const char* style;
  Scene scene;
};

void draw(const std::string& path) {
  const std::vector<Case> cases = {
      {"icosphere 3, sun", "a", scene_of(icosphere(3), {sun({0.4f, 1, 0.3f})})},
      {"icosphere 4, near lamp", "b",
       scene_of(icosphere(4), {lamp({0.5f, 1.25f, 0.375f}, {0.1f, 0.1f, 0.1f})})},
      {"plane of 32×32, lamp", "c", scene_of(grid(32, 1), {lamp({0, 0.25f, 0}, {0.05f, 0.05f, 0.05f})})}};
  constexpr double first = -4, last = 0, chosen = 0.003;  // powers of ten
  constexpr int n = 16;
  Drawing d(720, 420, "RMSE and jumps of the slope over the gradient weight");
  const Axes axes{60, 30, 560, 320, 0, 2.2};
  axes.frame(d, "gradient weight α", {0, 0.5, 1, 1.5, 2});
  for (int power = -4; power <= 0; ++power)
    d.words("m", axes((power - first) / (last - first), 0) + glm::dvec2(0, 18),
            power == 0 ? "1" : fmt::format("0.{:0>{}}", 1, -power));
  const double at = (std::log10(chosen) - first) / (last - first);
  d.line("s", axes(at, 0), axes(at, 2.2));
  d.words("m", axes(at, 2.2) + glm::dvec2(0, -8), "default 0.003");
  d.words("", {60, 400}, "Relative to α = 0. Whole lines: RMSE; dashed: jumps of the slope across edges.");
  double label = 0;
  for (const Case& c : cases) {
    std::vector<glm::dvec2> errors, jumps;
    double error_0 = 0, jump_0 = 0;
    for (int i = -1; i <= n; ++i) {
      const double x = double(std::max(i, 0)) / n;
      const double weight = i < 0 ? 0 : std::pow(10.0, first + (last - first) * x);
      const BakedColors baked =
          bake(c.scene, {.method = BakeMethod::least_squares, .gradient_weight = weight});
      const double error = surface_error(c.scene, baked, ErrorSpace::linear).rmse;
      const double jump = slope_jump(c.scene.mesh, baked.colors);
      if (i < 0) {
        error_0 = error, jump_0 = jump;
      } else if (error / error_0 <= 2.2) {
        errors.push_back(axes(x, error / error_0));
      }
      if (i >= 0) jumps.push_back(axes(x, jump / jump_0));
    }
    d.path(c.style, errors);
    d.path(fmt::format("{} d", c.style).c_str(), jumps);
    d.words(fmt::format("{} e", c.style).c_str(), {260, 70 + label}, c.name);
    label += 20;
  }
  d.write(path);
}

}  // namespace
}  // namespace lambake

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: draw_gradient_weight FILE.svg\n", stderr);
    return 2;
  }
  lambake::draw(argv[1]);
  return 0;
}
