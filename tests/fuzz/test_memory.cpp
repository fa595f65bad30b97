#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "fuzz/allocation_watch.h"
#include "fuzz/sample_mesh_files.h"
#include "lambake/io/scene_file.h"
#include "lambake/measure/bound.h"
#include "lambake/measure/surface_error.h"

namespace lambake {
namespace {

constexpr int n_side = 300;

/// The corners of the triangles of a floor of 300 × 300 vertices.
std::vector<std::array<int, 3>> floor_triangles() {
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i + 1 < n_side; ++i)
    for (int k = 0; k + 1 < n_side; ++k) {
      const int a = i * n_side + k;
      triangles.push_back({a, a + 1, a + n_side});
      triangles.push_back({a + 1, a + n_side + 1, a + n_side});
    }
  return triangles;
}

std::string position(int v) {
  return fmt::format("{:.6f} {:.6f} {:.6f}", v % n_side * 0.01, v * 1e-6, v / n_side * 0.01);
}

std::string obj(bool has_attributes) {
  std::string text;
  for (int v = 0; v < n_side * n_side; ++v) {
    text += "v " + position(v) + "\n";
    if (has_attributes)
      text += fmt::format("vt {:.6f} {:.6f}\nvn 0.0 {:.6f} 1.0\n", v * 1e-6, v * 2e-6, v * 1e-6);
  }
  for (auto [a, b, c] : floor_triangles()) {
    ++a, ++b, ++c;
    text += has_attributes ? fmt::format("f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}\n", a, b, c)
                           : fmt::format("f {} {} {}\n", a, b, c);
  }
  return text;
}

/// An OBJ in which each face has a normal of its own, so that every corner becomes a vertex.
std::string faceted_obj() {
  std::string text;
  for (int v = 0; v < n_side * n_side; ++v) text += "v " + position(v) + "\n";
  int n = 0;
  for (const auto& [a, b, c] : floor_triangles()) {
    ++n;
    text += fmt::format("vn {} 1 0\nf {}//{} {}//{} {}//{}\n", n, a + 1, n, b + 1, n, c + 1, n);
  }
  return text;
}

std::string ascii_ply() {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      n_side * n_side, floor_triangles().size());
  for (int v = 0; v < n_side * n_side; ++v)
    text += position(v) + fmt::format(" 0.0 {:.6f} 1.0 {:.6f} {:.6f}\n", v * 1e-6, v * 1e-6, v * 2e-6);
  for (const auto& [a, b, c] : floor_triangles()) text += fmt::format("3 {} {} {}\n", a, b, c);
  return text;
}

std::string off() {
  std::string text = fmt::format("OFF\n{} {} 0\n", n_side * n_side, floor_triangles().size());
  for (int v = 0; v < n_side * n_side; ++v) text += position(v) + "\n";
  for (const auto& [a, b, c] : floor_triangles()) text += fmt::format("3 {} {} {}\n", a, b, c);
  return text;
}

std::string ascii_stl() {
  std::string text = "solid floor\n";
  for (const auto& [a, b, c] : floor_triangles())
    text +=
        fmt::format("facet normal 0 1 0\nouter loop\nvertex {}\nvertex {}\nvertex {}\nendloop\nendfacet\n",
                    position(a), position(b), position(c));
  return text + "endsolid floor\n";
}

/// The most that reading takes, over the arrays of the scene with normals and baked colours.
double peak_over_scene(const std::string& name, const std::string& text, std::size_t n_vertices) {
  const std::string path = (std::filesystem::path(testing::TempDir()) / ("lambake_memory_" + name)).string();
  write_bytes(path, text);
  reset_peak_of_allocations();
  const SceneFile file = read_scene_file(path);
  const auto peak = static_cast<double>(peak_of_allocations());
  std::filesystem::remove(path);
  const Mesh& mesh = file.scene.mesh;
  EXPECT_EQ(mesh.n_vertices(), n_vertices);
  EXPECT_EQ(mesh.n_triangles(), floor_triangles().size());
  const std::size_t n_bytes =
      (36 + (mesh.texcoords[0].empty() ? 0 : 8)) * mesh.n_vertices() + 12 * mesh.n_triangles();
  return peak / static_cast<double>(n_bytes);
}

TEST(Memory, OfReadingAText_IsAtMostTwoAndAHalfTimesTheScene) {
  constexpr std::size_t n = n_side * n_side;
  EXPECT_LT(peak_over_scene("plain.obj", obj(false), n), 2.5);
  EXPECT_LT(peak_over_scene("attributes.obj", obj(true), n), 2.5);
  EXPECT_LT(peak_over_scene("faceted.obj", faceted_obj(), 3 * floor_triangles().size()), 2.5);
  EXPECT_LT(peak_over_scene("a.ply", ascii_ply(), n), 2.5);
  EXPECT_LT(peak_over_scene("a.off", off(), n), 2.5);
  EXPECT_LT(peak_over_scene("a.stl", ascii_stl(), n), 2.5);
}

/// The floor under a sun, without texture coordinates.
Scene floor_scene() {
  const std::string path = (std::filesystem::path(testing::TempDir()) / "lambake_memory_floor.ply").string();
  write_bytes(path, ascii_ply());
  Scene scene = read_scene_file(path).scene;
  std::filesystem::remove(path);
  scene.mesh.texcoords = {};
  scene.lights.push_back({.direction_to_light = {0, 1, 0}});
  return scene;
}

// The baked colours, a fifth of the scene, are among what it allocates.
TEST(Memory, OfLeastSquares_IsAtMostTwoAndAHalfTimesTheScene) {
  const Scene scene = floor_scene();
  const auto n_bytes = static_cast<double>(36 * scene.mesh.n_vertices() + 12 * scene.mesh.n_triangles());
  reset_peak_of_allocations();
  bake(scene, {.method = BakeMethod::least_squares});
  EXPECT_LT(static_cast<double>(peak_of_allocations()), 1.7 * n_bytes);
}

TEST(Memory, OfMeasuringTheSurface_IsAtMostOneAndAHalfTimesTheSceneBesideIt) {
  const Scene scene = floor_scene();
  const BakedColors baked = bake(scene, {});
  std::vector<LinearRgb> computed = baked.colors;
  computed[0].r += 0.001f;  // So that there are three measures.
  const auto n_bytes = static_cast<double>(36 * scene.mesh.n_vertices() + 12 * scene.mesh.n_triangles());
  reset_peak_of_allocations();
  surface_errors(scene, baked, computed);
  EXPECT_LT(static_cast<double>(peak_of_allocations()), 1.5 * n_bytes);
  reset_peak_of_allocations();
  surface_bound(scene, baked, {});
  EXPECT_LT(static_cast<double>(peak_of_allocations()), 1.5 * n_bytes);
}

}  // namespace
}  // namespace lambake
