// How time grows: processor time over vertices, lights, pixels and threads, with fitted exponents, as the
// Markdown tables of docs/performance.md. Run by `tool/bench growth`.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <functional>

#include "lambake/bake/bake.h"
#include "lambake/core/parallel.h"
#include "lambake/core/version.h"
#include "lambake/geometry/normals.h"
#include "lambake/render/framing.h"
#include "lambake/render/shade.h"
#include "lambake/render/visibility.h"
#include "wavy_floor.h"

namespace lambake {
namespace {

struct Times {
  double processor = 0, wall = 0;  ///< Seconds.
};

/// Medians of three runs, or of as many as fit into half a second.
Times time_of(const std::function<void()>& work) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> processor, wall;
  double total = 0;
  while (wall.size() < 3 || (total < 0.5 && wall.size() < 100)) {
    const std::clock_t begin = std::clock();
    const Clock::time_point wall_begin = Clock::now();
    work();
    processor.push_back(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
    wall.push_back(std::chrono::duration<double>(Clock::now() - wall_begin).count());
    total += wall.back();
  }
  const auto median = [](std::vector<double>& v) {
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
  };
  return {median(processor), median(wall)};
}

/// Slope of the least-squares line through log(y) over log(x).
double exponent(const std::vector<double>& x, const std::vector<double>& y) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double a = std::log(x[i]), b = std::log(y[i]);
    sx += a, sy += b, sxx += a * a, sxy += a * b;
  }
  const double n = static_cast<double>(x.size());
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/// One table: a row for each x, a column for each stage, ms of processor time, the exponents in the last row.
void print_growth(const std::string& of, const std::vector<double>& x, const std::vector<std::string>& stages,
                  const std::function<std::vector<double>(double)>& measure) {
  fmt::print("\n| {} | {} |\n|--:|{}|\n", of, fmt::join(stages, " | "),
             fmt::join(std::vector<std::string>(stages.size(), "--:"), "|"));
  std::vector<std::vector<double>> columns(stages.size());
  for (const double value : x) {
    const std::vector<double> row = measure(value);
    fmt::print("| {:.0f} |", value);
    for (std::size_t c = 0; c < row.size(); ++c) {
      columns[c].push_back(row[c]);
      fmt::print(" {:.3g} |", 1e3 * row[c]);
    }
    fmt::print("\n");
    std::fflush(stdout);
  }
  fmt::print("| **exponent** |");
  for (const std::vector<double>& column : columns) fmt::print(" {:.2f} |", exponent(x, column));
  fmt::print("\n");
}

Scene floor_scene(std::uint32_t side, std::size_t n_lamps) {
  Scene scene;
  scene.mesh = wavy_floor(side);
  scene.mesh.normals = vertex_normals(scene.mesh, NormalWeight::angle).normals;
  scene.materials.resize(1);
  scene.lights = n_lamps == 0 ? std::vector<Light>(1) : lamps_over_the_floor(n_lamps);
  return scene;
}

void run() {
  fmt::print("{}\nMilliseconds of processor time.\n", build_info());
  print_growth(
      "vertices", {1e3, 1e4, 1e5, 1e6, 1e7}, {"angle normals", "bake, sun", "bake, 16 lamps"}, [](double n) {
        Scene scene = floor_scene(static_cast<std::uint32_t>(std::lround(std::sqrt(n))), 0);
        const double normals = time_of([&] { vertex_normals(scene.mesh, NormalWeight::angle); }).processor;
        const double sun = time_of([&] { bake(scene, {}); }).processor;
        scene.lights = lamps_over_the_floor(16);
        return std::vector<double>{normals, sun, time_of([&] { bake(scene, {}); }).processor};
      });
  const Scene at_1e5 = floor_scene(316, 0);
  print_growth("lights, at 10^5 vertices", {1, 10, 100, 1e3, 1e4, 1e5}, {"plain sum", "merged, 0.25/255"},
               [&](double n) {
                 Scene scene = at_1e5;
                 scene.lights = lamps_over_the_floor(static_cast<std::size_t>(n));
                 BakeOptions plain;
                 plain.light_tolerance = 0;
                 return std::vector<double>{time_of([&] { bake(scene, plain); }).processor,
                                            time_of([&] { bake(scene, {}); }).processor};
               });
  print_growth(
      "pixels", {1e5, 1e6, 1e7, 3.3e7}, {"visibility", "shading per fragment, 4 lamps"}, [](double n) {
        const Scene scene = floor_scene(100, 4);
        const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(n)));
        const Camera camera = frame(scene.mesh.positions, 1);
        Visibility visibility;
        const double seen =
            time_of([&] { visibility = find_visibility(scene, scene.mesh, camera, side, side); }).processor;
        return std::vector<double>{seen, time_of([&] { shade_per_fragment(scene, visibility); }).processor};
      });
  fmt::print("\n| threads | wall, bake of 10^6 vertices under 64 lamps (ms) |\n|--:|--:|\n");
  const Scene scene = floor_scene(1000, 64);
  for (const std::size_t n : {1u, 2u}) {
    set_thread_count(n);
    fmt::print("| {} | {:.3g} |\n", n, 1e3 * time_of([&] { bake(scene, {}); }).wall);
  }
}

}  // namespace
}  // namespace lambake

int main() {
  lambake::run();
}
