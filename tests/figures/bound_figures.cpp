// Draws the figures of docs/bound.md with the functions that the page is about.
//
//     draw_bound_figures FOLDER      writes FOLDER/*.svg
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "figures/drawing.h"
#include "lambake/bake/bake.h"
#include "lambake/geometry/normals.h"
#include "lambake/shading/patch_bound.h"
#include "shapes.h"

namespace lambake {
namespace {

constexpr std::uint32_t the_light = 0;

/// A triangle whose first corner faces away from the sun; G by `sample`.
struct Example {
  std::vector<Light> lights;
  std::vector<std::uint32_t> indices = {the_light};
  Patch patch;

  Example() {
    Light sun;
    sun.direction_to_light = {0, 1, 0};
    lights = {sun};
    const auto normal = [](double degrees, double sideways) {
      const double r = degrees * 3.14159265358979 / 180;
      return glm::normalize(glm::dvec3(std::sin(r), std::cos(r), sideways));
    };
    patch.positions = {{-1, 0, 0}, {1, 0, 0}, {0, 0, 1.5}};
    patch.normals = {normal(118, 0), normal(35, 0), normal(72, 0.45)};
    for (int c = 0; c < 3; ++c) {
      glm::dvec3 corner(0);
      corner[c] = 1;
      patch.colors[c] = reference(corner);
    }
  }
  glm::dvec3 reference(const glm::dvec3& b) const { return reference_at(patch, lights, indices, false, b); }
  double f(double t) const { return reference({1 - t, t, 0}).r; }
  double g(double t) const { return (patch.colors * glm::dvec3(1 - t, t, 0)).r; }
  double s(int corner) const { return facing(lights[0], patch.positions[corner], patch.normals[corner]); }
};

/// F and G along the edge that the terminator crosses, and the kink between them.
void draw_kink(const std::string& path) {
  const Example e;
  Drawing d(760, 400, "Light along an edge, per pixel and per vertex");
  const Axes axes{70, 30, 640, 310, -0.1, 0.9};
  axes.frame(d, "along the edge, from the corner in the dark", {0, 0.2, 0.4, 0.6, 0.8});
  const double s = e.s(1), t = -e.s(0), at = t / (s + t), kink = s * t / (s + t);
  std::vector<glm::dvec2> between = curve(axes, [&](double x) { return e.f(x); });
  const std::vector<glm::dvec2> above = curve(axes, [&](double x) { return e.g(x); });
  between.insert(between.end(), above.rbegin(), above.rend());
  d.path("fa", between, true);
  d.path("a", curve(axes, [&](double x) { return e.f(x); }));
  d.path("b", curve(axes, [&](double x) { return e.g(x); }));
  d.path("s d", {axes(at, 0), axes(at, 0.85)});
  d.path("c", {axes(at, e.f(at)), axes(at, e.g(at))});
  d.words("b e", axes(0.42, e.g(0.42)) + glm::dvec2(-10, -10), "G: per vertex");
  d.words("a", axes(0.86, e.f(0.86)) + glm::dvec2(-120, -8), "F: per pixel");
  d.words("c", axes(0.52, 0.16), fmt::format("s·t/(s + t) = {:.3f}, here {:.3f}", kink, e.g(at) - e.f(at)));
  d.words("", axes(at, 0.85) + glm::dvec2(8, 4), "terminator: n·ω = 0");
  d.words("k", axes(0, 0) + glm::dvec2(4, 22), fmt::format("n·ω = −t = −{:.2f}", t));
  d.words("k e", axes(1, 0) + glm::dvec2(-4, 22), fmt::format("n·ω = s = {:.2f}", s));
  d.write(path);
}

/// Enclosures of F along the same edge: one over all of it, and one for each side of the terminator.
void draw_enclosure(const std::string& path) {
  const Example e;
  Drawing d(760, 560, "Enclosures of the light along an edge");
  const Patch edge = part_of(e.patch, glm::dmat3({1, 0, 0}, {0, 1, 0}, {0, 1, 0}));
  const double at = terminator_on_edge(e.lights[0], edge, 0, 1);
  const auto draw = [&](const Axes& axes, const std::vector<double>& ends, const char* name) {
    axes.frame(d, "along the edge", {0, 0.5, 1});
    d.words("k", {axes.left, axes.top - 8}, name);
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      const glm::dvec3 from(1 - ends[i], ends[i], 0), to(1 - ends[i + 1], ends[i + 1], 0);
      const Patch part = part_of(e.patch, glm::dmat3(from, to, to));
      const Enclosure light = light_over(e.lights[0], part);
      const auto value = [&](double x, double offset) {
        const double u = (x - ends[i]) / (ends[i + 1] - ends[i]);
        return light.linear[0] * (1 - u) + light.linear[1] * u + light.quadratic[0] * u * (1 - u) +
               light.quadratic[2] * u * (1 - u) + offset;
      };
      std::vector<glm::dvec2> band = curve(
          axes, [&](double x) { return value(x, light.low); }, ends[i], ends[i + 1]);
      const std::vector<glm::dvec2> top = curve(
          axes, [&](double x) { return value(x, light.high); }, ends[i], ends[i + 1]);
      band.insert(band.end(), top.rbegin(), top.rend());
      d.path("fa", band, true);
      d.path("a w", band, true);
      d.words("a m", axes(0.5 * (ends[i] + ends[i + 1]), ends.size() == 2 ? 1.1 : 0.92),
              fmt::format("±{:.3f}", 0.5 * (light.high - light.low)));
    }
    d.path("", curve(axes, [&](double x) { return e.f(x); }));
  };
  draw({70, 36, 640, 230, -0.6, 1.4}, {0, 1}, "One enclosure of F over the whole edge");
  draw({70, 346, 640, 170, -0.1, 1}, {0, at, 0.5 * (1 + at), 1},
       "Cut at the terminator, and the lit side once more");
  d.write(path);
}

/// The same linear difference at two places of the curve of the screen.
void draw_screen(const std::string& path) {
  Drawing d(560, 440, "The curve of the screen and one difference at two places of it");
  const Axes axes{70, 24, 460, 350, 0, 1};
  axes.frame(d, "linear light", {0, 0.25, 0.5, 0.75, 1});
  d.path("", curve(axes, [](double x) { return srgb_encode(x); }));
  constexpr double e = 0.08;
  for (const auto& [g, style] : {std::pair{0.02, "b"}, {0.55, "a"}}) {
    const double low = srgb_encode(g), high = srgb_encode(g + e);
    d.path(style, {axes(g, 0), axes(g, low), axes(0, low)});
    d.path(style, {axes(g + e, 0), axes(g + e, high), axes(0, high)});
    d.words(style, axes(g + e, low) + glm::dvec2(10, -0.5 * (high - low) * 350 + 4),
            fmt::format("e = {:.2f} shows as {:.0f}/255", e, 255 * (high - low)));
  }
  d.words("k", axes(0.36, 0.56), "S, concave");
  d.write(path);
}

/// Branch and bound on the whole triangle: the part with the largest bound is divided, at the terminator or
/// across its longest side, until the largest bound is within 10 % of the largest error found.
void draw_pieces(const std::string& path) {
  const Example e;
  struct Piece {
    glm::dmat3 corners;
    double bound;
  };
  std::vector<double> bounds;
  double found = 0;
  const auto bounded = [&](const glm::dmat3& corners) {
    // One enclosure, and the error at four points, as of any triangle.
    BoundOptions once;
    once.space = ErrorSpace::linear;
    once.max_parts = 1;
    const PatchBound b = bound_patch(part_of(e.patch, corners), FinishRange{}, e.lights, e.indices, once);
    found = std::max(found, b.found);
    return Piece{corners, b.bound};
  };
  std::vector<Piece> pieces = {bounded(glm::dmat3(1.0))};
  const auto worst = [&] {
    return std::max_element(pieces.begin(), pieces.end(),
                            [](const Piece& a, const Piece& b) { return a.bound < b.bound; });
  };
  bounds.push_back(worst()->bound);
  while (worst()->bound > 1.1 * found && pieces.size() < 60) {
    const Piece piece = *worst();
    pieces.erase(worst());
    std::vector<glm::dmat3> parts;
    cut_at_terminator(e.lights[0], e.patch, piece.corners, parts);
    if (parts.size() < 2) {
      const Patch part = part_of(e.patch, piece.corners);
      int longest = 0;
      double length = 0;
      for (int k = 0; k < 3; ++k)
        if (const double l = glm::length(part.normals[(k + 1) % 3] - part.normals[k]); l > length)
          longest = k, length = l;
      const glm::dvec3 &a = piece.corners[longest], &b = piece.corners[(longest + 1) % 3],
                       &c = piece.corners[(longest + 2) % 3];
      parts = {glm::dmat3(a, 0.5 * (a + b), c), glm::dmat3(0.5 * (a + b), b, c)};
    }
    for (const glm::dmat3& part : parts) {
      Piece child = bounded(part);
      child.bound = std::min(child.bound, piece.bound);
      pieces.push_back(child);
    }
    bounds.push_back(worst()->bound);
  }
  Drawing d(760, 380, "The parts that a triangle is divided into");
  const auto place = [](const glm::dvec3& b) {
    return glm::dvec2(30, 340) * b[0] + glm::dvec2(430, 340) * b[1] + glm::dvec2(230, 30) * b[2];
  };
  for (const Piece& p : pieces)
    d.path("fb", {place(p.corners[0]), place(p.corners[1]), place(p.corners[2])}, true,
           0.75 * p.bound / bounds.front());
  d.words("", {30, 362}, "in the dark");
  d.words("e", {430, 362}, "lit");
  d.words("k", {470, 60}, fmt::format("{} parts, stronger where the bound is larger", pieces.size()));
  d.words("k", {470, 84}, fmt::format("largest bound of one enclosure: {:.3f}", bounds.front()));
  d.words("k", {470, 108}, fmt::format("of the parts: {:.3f}", bounds.back()));
  d.words("k", {470, 132}, fmt::format("largest error found: {:.3f}", found));
  const Axes axes{500, 180, 220, 150, 0, std::ceil(10 * bounds.front()) / 10};
  axes.frame(d, "divisions", {0, axes.y1});
  std::vector<glm::dvec2> steps;
  for (std::size_t i = 0; i < bounds.size(); ++i)
    steps.push_back(
        axes(static_cast<double>(i) / static_cast<double>(std::max<std::size_t>(1, bounds.size() - 1)),
             bounds[i]));
  d.path("b", steps);
  d.line("c d", axes(0, found), axes(1, found));
  d.words("b", axes(0.3, bounds.front()) + glm::dvec2(0, 4), "bound");
  d.words("c", axes(0.02, found) + glm::dvec2(0, 16), "found");
  d.write(path);
}

/// A coarse sphere before and after `adaptive`, seen from where the terminator is; and the sun's terminator.
void draw_cut(const std::string& path) {
  Scene scene;
  scene.mesh = icosphere(2);
  scene.mesh.normals = vertex_normals(scene.mesh, NormalWeight::angle).normals;
  scene.materials.resize(1);
  Light sun;
  sun.direction_to_light = glm::normalize(glm::vec3(0.4f, 1, 0.3f));
  scene.lights = {sun};
  const BakedColors baked = bake(scene, {.method = BakeMethod::adaptive});
  Drawing d(760, 410, "A sphere before and after cutting, as wires");
  const glm::dvec3 eye = glm::normalize(glm::dvec3(0.9, 0.25, 1)),
                   right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), eye)), up = glm::cross(eye, right);
  const auto draw = [&](const Mesh& mesh, const glm::dvec2& middle, const std::string& name) {
    const auto place = [&](const glm::dvec3& p) {
      return middle + 170.0 * glm::dvec2(glm::dot(p, right), -glm::dot(p, up));
    };
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
      if (glm::dot(glm::cross(b - a, c - a), eye) <= 0) continue;
      for (int k = 0; k < 3; ++k) edges.emplace_back(std::minmax(t[k], t[(k + 1) % 3]));
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    for (const auto& [a, b] : edges)
      d.line("w", place(glm::dvec3(mesh.positions[a])), place(glm::dvec3(mesh.positions[b])));
    // The circle where n·ω = 0, of the sphere that the normals stand for.
    const glm::dvec3 w(sun.direction_to_light), u = glm::normalize(glm::cross(w, glm::dvec3(0, 0, 1))),
                                                v = glm::cross(w, u);
    std::vector<glm::dvec2> arc;
    for (int i = 0; i <= 720; ++i) {
      const double angle = i * 3.14159265358979 / 360;
      const glm::dvec3 p = std::cos(angle) * u + std::sin(angle) * v;
      if (glm::dot(p, eye) > 0) {
        arc.push_back(place(p));
      } else if (!arc.empty()) {
        d.path("b d", arc);
        arc.clear();
      }
    }
    if (!arc.empty()) d.path("b d", arc);
    d.words("k m", middle + glm::dvec2(0, 195), name);
  };
  draw(scene.mesh, {190, 190}, fmt::format("{} triangles", scene.mesh.n_triangles()));
  draw(*baked.mesh, {570, 190},
       fmt::format("{} triangles: at most {:.3g}/255, certified", baked.mesh->n_triangles(),
                   255 * baked.certificate->max_bound));
  d.words("b", {330, 30}, "terminator");
  d.write(path);
}

}  // namespace
}  // namespace lambake

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: draw_bound_figures FOLDER\n", stderr);
    return 2;
  }
  const std::string folder = std::string(argv[1]) + "/";
  lambake::draw_kink(folder + "kink.svg");
  lambake::draw_enclosure(folder + "enclosure.svg");
  lambake::draw_screen(folder + "screen.svg");
  lambake::draw_pieces(folder + "pieces.svg");
  lambake::draw_cut(folder + "cut.svg");
  return 0;
}
