#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "lambake/render/framing.h"
#include "lambake/render/shade.h"
#include "lambake/render/visibility.h"
#ifdef LAMBAKE_HAS_OSMESA
#include "llvmpipe.h"
#endif

/// A frame of 1920×1080: who is seen, then light per fragment, against Mesa's llvmpipe on the same mesh,
/// camera and lights. CPU time of all threads counts. The ratios are printed after the table.
namespace lambake::bench {
namespace {

constexpr std::uint32_t width = 1920, height = 1080;

/// A bumpy sphere of about `n_triangles` that fills the height of the picture, under lamps around it.
Scene bumpy_sphere(std::size_t n_triangles, std::size_t n_lamps) {
  Scene scene;
  scene.materials.emplace_back();
  Mesh& mesh = scene.mesh;
  const auto rows = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(n_triangles) / 4));
  const std::uint32_t columns = 2 * rows;
  const auto point = [](double u, double v) {
    const double longitude = 6.283185307179586 * u, latitude = 3.141592653589793 * (v - 0.5);
    const double radius = 1 + 0.04 * std::sin(9 * longitude) * std::cos(7 * latitude) * std::cos(latitude);
    return radius * glm::dvec3(std::cos(latitude) * std::sin(longitude), std::sin(latitude),
                               std::cos(latitude) * std::cos(longitude));
  };
  for (std::uint32_t j = 0; j <= rows; ++j)
    for (std::uint32_t i = 0; i <= columns; ++i) {
      const double u = double(i) / columns, v = double(j) / rows, h = 1e-4;
      const glm::dvec3 normal =
          glm::cross(point(u + h, v) - point(u - h, v), point(u, v + h) - point(u, v - h));
      mesh.positions.emplace_back(point(u, v));
      mesh.normals.emplace_back(glm::length(normal) > 0 ? glm::normalize(normal) : point(u, v));
    }
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i) {
      const std::uint32_t a = j * (columns + 1) + i, b = a + 1, c = b + columns + 1, d = c - 1;
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
    }
  for (std::size_t i = 0; i < n_lamps; ++i) {
    const float angle = 6.2831853f * static_cast<float>(i) / static_cast<float>(n_lamps);
    Light lamp;
    lamp.type = LightType::point;
    lamp.position = {2 * std::cos(angle), 1 + std::sin(3 * angle), 2 * std::sin(angle)};
    lamp.intensity = LinearRgb{1, 0.8f, 0.6f} * (0.8f / static_cast<float>(n_lamps));
    scene.lights.push_back(lamp);
  }
  return scene;
}

Camera close_camera() {
  return look_at({0.8f, 1.2f, 3.4f}, {0, 0, 0}, 0.6f);
}

void ours(benchmark::State& state) {
  const Scene scene =
      bumpy_sphere(static_cast<std::size_t>(state.range(0)), static_cast<std::size_t>(state.range(1)));
  Picture picture;
  std::size_t n_covered = 0;
  for (auto _ : state) n_covered = render_per_fragment(scene, close_camera(), width, height, picture);
  state.counters["covered_pixels"] = static_cast<double>(n_covered);
}

void visibility_alone(benchmark::State& state) {
  const Scene scene = bumpy_sphere(static_cast<std::size_t>(state.range(0)), 1);
  for (auto _ : state)
    visit_visible_tiles(scene, scene.mesh, close_camera(), width, height, [](const VisibleTile&) {});
}

#ifdef LAMBAKE_HAS_OSMESA
/// Median difference between the two pictures' 8 bit values, to know that both draw the same: rounding alone
/// leaves a quarter.
double median_difference(const Llvmpipe& theirs, const Scene& scene) {
  const Visibility seen = find_visibility(scene, scene.mesh, close_camera(), width, height);
  const Picture picture = shade_per_fragment(scene, seen);
  std::vector<double> differences;
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t i = y * width + x, j = (height - 1 - y) * width + x;
      if (seen.triangles[i] == no_triangle) continue;
      const double value = std::clamp(double(picture.pixels[i].r), 0.0, 1.0) * 255;
      differences.push_back(std::abs(value - theirs.pixels()[4 * j]));
    }
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle;
}

void llvmpipe(benchmark::State& state) {
  const Scene scene =
      bumpy_sphere(static_cast<std::size_t>(state.range(0)), static_cast<std::size_t>(state.range(1)));
  Llvmpipe theirs(scene, close_camera(), width, height);
  theirs.draw();
  for (auto _ : state) theirs.draw();
  state.counters["median_difference_of_255"] = median_difference(theirs, scene);
}
#endif

void cases(benchmark::internal::Benchmark* b) {
  b->ArgNames({"triangles", "lamps"})->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
  for (const std::int64_t triangles : {20'000, 200'000, 2'000'000})
    for (const std::int64_t lamps : {1, 16}) b->Args({triangles, lamps});
}

BENCHMARK(ours)->Apply(cases);
BENCHMARK(visibility_alone)
    ->ArgName("triangles")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->Arg(20'000)
    ->Arg(2'000'000);
#ifdef LAMBAKE_HAS_OSMESA
BENCHMARK(llvmpipe)->Apply(cases);
#endif

/// Keeps the CPU times, so that ratios can be told at the end.
class RatioReporter : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs)
      if (!run.error_occurred) cpu_ms_[run.benchmark_name()] = run.GetAdjustedCPUTime();
  }
  void Finalize() override {
    for (const auto& [name, ms] : cpu_ms_) {
      if (!name.starts_with("ours/")) continue;
      const auto theirs = cpu_ms_.find("llvmpipe/" + name.substr(5));
      if (theirs != cpu_ms_.end())
        std::printf("%-50s llvmpipe / ours = %.2f\n", name.substr(5).c_str(), theirs->second / ms);
    }
  }

 private:
  std::map<std::string, double> cpu_ms_;
};

}  // namespace
}  // namespace lambake::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  lambake::bench::RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}
