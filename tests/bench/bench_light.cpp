// Light at vertices against what bounds it in the same run: the bandwidth of a copy where there is one light,
// a bare loop of the same arithmetic where there are many, the plain sum where there are very many.
// `tool/bench` runs it and prints the ratios.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <cstring>
#include <numeric>
#include <vector>

#include "bare_loop.h"
#include "lambake/core/parallel.h"
#include "lambake/geometry/normals.h"
#include "lambake/shading/light_kernel.h"
#include "lambake/shading/light_tree.h"
#include "wavy_floor.h"

namespace lambake {
namespace {

constexpr std::size_t side = 1000, n_vertices = side * side, block = 1024;

const Mesh& floor_mesh() {
  static const Mesh mesh = [] {
    Mesh m = wavy_floor(side);
    m.normals = vertex_normals(m, NormalWeight::angle).normals;
    return m;
  }();
  return mesh;
}

std::vector<LinearRgb>& output() {
  static std::vector<LinearRgb> out(n_vertices);
  return out;
}

void copy_12_bytes_a_vertex(benchmark::State& state) {
  const Mesh& mesh = floor_mesh();
  for (auto _ : state) {
    parallel_blocks(n_vertices, 16 * block, [&](std::size_t begin, std::size_t end) {
      std::memcpy(static_cast<void*>(&output()[begin]), &mesh.normals[begin], 12 * (end - begin));
    });
    benchmark::ClobberMemory();
  }
}
BENCHMARK(copy_12_bytes_a_vertex)->MeasureProcessCPUTime()->UseRealTime();

void one_sun(benchmark::State& state) {
  const Mesh& mesh = floor_mesh();
  const std::vector<Light> sun(1);
  for (auto _ : state) irradiance_within(sun, 0, mesh.positions, mesh.normals, output());
}
BENCHMARK(one_sun)->MeasureProcessCPUTime()->UseRealTime();

void bare_loop_256_lamps(benchmark::State& state) {
  const Mesh& mesh = floor_mesh();
  std::vector<float> p[3], n[3], out[3];
  for (int c = 0; c < 3; ++c) {
    p[c].resize(n_vertices), n[c].resize(n_vertices), out[c].resize(n_vertices);
    for (std::size_t v = 0; v < n_vertices; ++v) p[c][v] = mesh.positions[v][c], n[c][v] = mesh.normals[v][c];
  }
  std::vector<float> lights;
  for (const Light& light : lamps_over_the_floor(256))
    lights.insert(lights.end(), {light.position.x, light.position.y, light.position.z, light.intensity.r,
                                 light.intensity.g, light.intensity.b});
  for (auto _ : state)
    parallel_blocks(n_vertices, block, [&](std::size_t begin, std::size_t end) {
      bare_loop({&p[0][begin], &p[1][begin], &p[2][begin]}, {&n[0][begin], &n[1][begin], &n[2][begin]},
                {&out[0][begin], &out[1][begin], &out[2][begin]}, end - begin, lights.data(), 256);
    });
}
BENCHMARK(bare_loop_256_lamps)->MeasureProcessCPUTime()->UseRealTime();

void lamps_256(benchmark::State& state) {
  const Mesh& mesh = floor_mesh();
  const std::vector<Light> lights = lamps_over_the_floor(256);
  for (auto _ : state) irradiance_within(lights, 0, mesh.positions, mesh.normals, output());
}
BENCHMARK(lamps_256)->MeasureProcessCPUTime()->UseRealTime();

void lamps_plain(benchmark::State& state) {
  const Mesh& mesh = floor_mesh();
  const std::vector<Light> lights = lamps_over_the_floor(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) irradiance_within(lights, 0, mesh.positions, mesh.normals, output());
}
BENCHMARK(lamps_plain)->Arg(1000)->Arg(10000)->MeasureProcessCPUTime()->UseRealTime();

void lamps_merged(benchmark::State& state) {
  const Mesh& mesh = floor_mesh();
  const std::vector<Light> lights = lamps_over_the_floor(static_cast<std::size_t>(state.range(0)));
  LightError error;
  for (auto _ : state) error = irradiance_within(lights, 0.25 / 255, mesh.positions, mesh.normals, output());
  state.counters["certified_steps_of_255"] = 255 * error.display;
}
BENCHMARK(lamps_merged)->Arg(1000)->Arg(10000)->MeasureProcessCPUTime()->UseRealTime();

/// Where normals turn much within two dozen vertices: ripples of a steepest slope in hundredths.
void lamps_10000_merged_on_ripples(benchmark::State& state) {
  Mesh mesh = wavy_floor(side, 0.01f * static_cast<float>(state.range(0)));
  mesh.normals = vertex_normals(mesh, NormalWeight::angle).normals;
  const std::vector<Light> lights = lamps_over_the_floor(10000);
  LightError error;
  for (auto _ : state) error = irradiance_within(lights, 0.25 / 255, mesh.positions, mesh.normals, output());
  state.counters["certified_steps_of_255"] = 255 * error.display;
}
BENCHMARK(lamps_10000_merged_on_ripples)->Arg(10)->Arg(40)->MeasureProcessCPUTime()->UseRealTime();

/// Leaves nothing of other arrays in the caches, and nothing to be written back.
void fill_caches() {
  static const std::vector<std::uint64_t> other(std::size_t{1} << 25, 1);  // 256 MB
  parallel_blocks(other.size(), 256 * block, [&](std::size_t begin, std::size_t end) {
    benchmark::DoNotOptimize(std::accumulate(&other[begin], &other[begin] + (end - begin), std::uint64_t{0}));
  });
}

/// Calls `work` over and over. A cache holds half of the floor and of its copy, and other work on the machine
/// some of that: from_memory starts each time without, as after the reading of a file.
template <typename Work>
void measure(benchmark::State& state, const Work& work) {
  const bool from_memory = state.range(0) != 0;
  for (auto _ : state) {
    if (from_memory) {
      state.PauseTiming();
      fill_caches();
      state.ResumeTiming();
    }
    work();
  }
}

void copy_positions_and_triangles(benchmark::State& state) {
  const Mesh& mesh = floor_mesh();
  std::vector<glm::vec3> positions(mesh.n_vertices());
  std::vector<glm::uvec3> triangles(mesh.n_triangles());
  measure(state, [&] {
    parallel_blocks(positions.size(), 16 * block, [&](std::size_t begin, std::size_t end) {
      std::copy(&mesh.positions[begin], &mesh.positions[begin] + (end - begin), &positions[begin]);
    });
    parallel_blocks(triangles.size(), 16 * block, [&](std::size_t begin, std::size_t end) {
      std::copy(&mesh.triangles[begin], &mesh.triangles[begin] + (end - begin), &triangles[begin]);
    });
    benchmark::ClobberMemory();
  });
}
BENCHMARK(copy_positions_and_triangles)
    ->ArgName("from_memory")
    ->Arg(0)
    ->Arg(1)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void normals_by_angle(benchmark::State& state) {
  const Mesh& mesh = floor_mesh();
  measure(state, [&] { benchmark::DoNotOptimize(vertex_normals(mesh, NormalWeight::angle)); });
}
BENCHMARK(normals_by_angle)->ArgName("from_memory")->Arg(0)->Arg(1)->MeasureProcessCPUTime()->UseRealTime();

void normals_by_area(benchmark::State& state) {
  const Mesh& mesh = floor_mesh();
  measure(state, [&] { benchmark::DoNotOptimize(vertex_normals(mesh, NormalWeight::area)); });
}
BENCHMARK(normals_by_area)->ArgName("from_memory")->Arg(0)->Arg(1)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
}  // namespace lambake

BENCHMARK_MAIN();
