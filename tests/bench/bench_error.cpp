// The error over the surface, integrated and bounded, and the cut that removes it, by triangle and light;
// beside them what it takes to read the mesh from a binary PLY. `tool/bench` runs it and prints the ratios.
#include <benchmark/benchmark.h>

#include <filesystem>
#include <string>

#include "lambake/bake/bake.h"
#include "lambake/geometry/normals.h"
#include "lambake/io/ply_write.h"
#include "lambake/io/scene_file.h"
#include "lambake/measure/bound.h"
#include "lambake/measure/surface_error.h"
#include "wavy_floor.h"

namespace lambake {
namespace {

constexpr std::uint32_t side = 300;  // 178,802 triangles

/// A floor under a low sun, whose terminator crosses the waves, or under `n_lamps` lamps.
Scene floor_under(std::int64_t n_lamps) {
  Scene scene;
  scene.mesh = wavy_floor(side);
  scene.mesh.normals = vertex_normals(scene.mesh, NormalWeight::angle).normals;
  scene.materials.resize(1);
  scene.lights = lamps_over_the_floor(static_cast<std::size_t>(n_lamps));
  if (n_lamps == 0) scene.lights.push_back({.direction_to_light = glm::normalize(glm::vec3(1, 0.15f, 0.2f))});
  return scene;
}

void tell_work(benchmark::State& state, const Scene& scene) {
  const auto n = static_cast<double>(scene.mesh.n_triangles() * scene.lights.size());
  state.counters["s_per_triangle_and_light"] =
      benchmark::Counter(n, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void read_ply(benchmark::State& state) {
  const Scene scene = floor_under(0);
  const std::string path = (std::filesystem::temp_directory_path() / "lambake_bench_error.ply").string();
  write_ply_file(path, scene, bake(scene, {}), {});
  for (auto _ : state) benchmark::DoNotOptimize(read_scene_file(path));
  std::filesystem::remove(path);
}
BENCHMARK(read_ply)->MeasureProcessCPUTime()->UseRealTime();

void integrate_error(benchmark::State& state) {
  const Scene scene = floor_under(state.range(0));
  const BakedColors baked = bake(scene, {});
  for (auto _ : state) benchmark::DoNotOptimize(surface_error(scene, baked, ErrorSpace::display));
  tell_work(state, scene);
}
BENCHMARK(integrate_error)->Arg(0)->Arg(16)->Arg(64)->MeasureProcessCPUTime()->UseRealTime();

void bound_error(benchmark::State& state) {
  const Scene scene = floor_under(state.range(0));
  const BakedColors baked = bake(scene, {});
  for (auto _ : state) benchmark::DoNotOptimize(surface_bound(scene, baked, {.accept = 1.0 / 255}));
  tell_work(state, scene);
}
BENCHMARK(bound_error)->Arg(0)->Arg(16)->Arg(64)->MeasureProcessCPUTime()->UseRealTime();

void cut_adaptively(benchmark::State& state) {
  const Scene scene = floor_under(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(bake(scene, {.method = BakeMethod::adaptive}));
  tell_work(state, scene);
}
BENCHMARK(cut_adaptively)->Arg(0)->Arg(16)->Arg(64)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
}  // namespace lambake

BENCHMARK_MAIN();
