#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "lambake/bake/color_output.h"
#include "lambake/core/progress.h"
#include "lambake/io/color_storage.h"
#include "lambake/report/timing.h"
#include "lambake/scene/scene.h"

namespace lambake {

/// One way to bake, measured. Errors are of what a file of the result shows, against the scene's own
/// per-fragment light, on the surface and on screen.
struct MethodRun {
  std::string method;   ///< As on the command line: "sample".
  std::string variant;  ///< What distinguishes it within the method: "normals area"; may be empty.
  Timing one_thread, all_threads;
  std::size_t n_vertices = 0, n_triangles = 0;
  std::size_t bytes = 0;  ///< Arrays of the result as stored: positions, normals, colours, indices.
  double rmse = 0, max_sampled = 0;
  double max_bound = 0;  ///< Certified; infinite where a light lies on the surface.

  std::string label() const { return variant.empty() ? method : method + ", " + variant; }
};

/// One picture of the scene, drawn both ways.
struct FrameRun {
  std::uint32_t width = 0, height = 0;
  std::size_t n_covered = 0;  ///< Pixels that are lit.
  Timing per_vertex;          ///< Finding what is seen and interpolating baked colours.
  Timing per_fragment;        ///< Finding what is seen and lighting each pixel.
  Timing per_vertex_one_thread, per_fragment_one_thread;
};

/// The cost of more lights: lamps around the model.
struct LightsRun {
  std::size_t n_lights = 0;
  Timing per_vertex;    ///< A bake by `sample`.
  Timing per_fragment;  ///< Lighting each pixel of a picture of 1280×720.
};

struct ChartRun {
  std::string input, command, version;
  std::size_t n_vertices = 0, n_triangles = 0, n_lights = 0, n_threads = 0;
  std::vector<MethodRun> methods;
  std::string verdict;        ///< Of `auto` at 1/255; empty where it was not run.
  std::string chosen_method;  ///< The method that `auto` took.
  std::vector<FrameRun> frames;
  std::vector<LightsRun> lights;
  std::vector<std::string> left_out;  ///< What the budget did not allow.
  double seconds = 0;                 ///< Taken by all of it.
};

struct ChartRunOptions {
  std::vector<std::string> methods{};  ///< Names of methods to run; empty: all of chart_methods().
  double budget_seconds = 60;          ///< Nothing new is begun after it; methods take at most half of it.
  Camera camera{};                     ///< For the frames.
  /// What a file makes of colours that it stores so: errors are of what it shows. None: exactly the colours.
  std::function<ColorOutput(ColorStorage)> output{};
  Progress progress{};
};

/// The names that ChartRunOptions::methods takes.
std::vector<std::string> chart_methods();

/// Measures time against error for every method, then frames and lights. Times are medians of repeats; the
/// errors are the same on every machine: methods that the budget ends before they are done are left out.
/// @param scene  with normals (V). @throws InvalidOption for an unknown method or a budget that is not > 0.
ChartRun run_chart(const Scene& scene, const ChartRunOptions& options);

}  // namespace lambake
