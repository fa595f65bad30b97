#include "lambake/report/chart_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <numbers>

#include "lambake/bake/bake.h"
#include "lambake/core/bounds.h"
#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/geometry/normals.h"
#include "lambake/geometry/robust_normals.h"
#include "lambake/measure/bound.h"
#include "lambake/measure/select.h"
#include "lambake/measure/surface_error.h"
#include "lambake/render/shade.h"
#include "lambake/render/visibility.h"

namespace lambake {
namespace {

/// A way to bake, and what it is called.
struct Variant {
  std::string method, name;
  std::function<BakedColors(const Scene&, const ColorOutput&)> bake;
  ColorStorage color = ColorStorage::u16;  ///< The default of glTF.
};

std::size_t bytes_of(ColorStorage color) {
  return color == ColorStorage::u8 ? 4 : color == ColorStorage::u16 ? 8 : 12;
}

BakedColors bake_with_normals(const Scene& scene, const std::function<VertexNormals(const Mesh&)>& normals) {
  Scene other = scene;
  other.mesh.normals = normals(other.mesh).normals;
  return bake(other, {.method = BakeMethod::sample});
}

/// @param max_seconds  for methods that cut until they are done.
std::vector<Variant> variants(double max_seconds) {
  const auto with = [](const BakeOptions& options) {
    return [options](const Scene& scene, const ColorOutput& output) {
      BakeOptions how = options;
      how.output = output;
      return bake(scene, how);
    };
  };
  // What matters most first: the budget may end before the last.
  std::vector<Variant> all = {{"sample", "", with({.method = BakeMethod::sample})},
                              {"face", "", with({.method = BakeMethod::face})}};
  const auto add_adaptive = [&](int steps) {
    all.push_back(
        {"adaptive", fmt::format("{}/255", steps),
         with({.method = BakeMethod::adaptive, .tolerance = steps / 255.0, .max_seconds = max_seconds})});
  };
  add_adaptive(1);
  all.push_back({"least-squares", "", with({.method = BakeMethod::least_squares})});
  all.push_back({"average", "", with({.method = BakeMethod::average})});
  const auto with_normals = [&](const char* name, const std::function<VertexNormals(const Mesh&)>& normals) {
    all.push_back(
        {"sample", fmt::format("normals {}", name),
         [normals](const Scene& scene, const ColorOutput&) { return bake_with_normals(scene, normals); }});
  };
  for (const auto& [weight, name] : {std::pair{NormalWeight::angle, "angle"},
                                     {NormalWeight::area, "area"},
                                     {NormalWeight::uniform, "uniform"},
                                     {NormalWeight::max, "max"}})
    with_normals(name, [weight = weight](const Mesh& mesh) { return vertex_normals(mesh, weight); });
  with_normals("robust", robust_normals);
  const auto sample = with({.method = BakeMethod::sample});
  all.push_back({"sample", "stored as u8", sample, ColorStorage::u8});
  all.push_back({"sample", "stored as f32", sample, ColorStorage::f32});
  add_adaptive(2);
  add_adaptive(4);
  for (const int levels : {1, 2})
    all.push_back({"uniform", fmt::format("level {}", levels),
                   with({.method = BakeMethod::uniform, .levels = levels})});
  return all;
}

/// Time left, and what could not be begun for want of it.
class Budget {
 public:
  Budget(double seconds, const Progress& progress) : seconds_(seconds), progress_(progress) {}
  double spent() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  /// Whether work called `name` may begin before this share of the time is over; tells the progress.
  bool allows(const std::string& name, double share, std::vector<std::string>& left_out) const {
    if (spent() >= share * seconds_) {
      left_out.push_back(name);
      return false;
    }
    report_progress(progress_, name, spent() / seconds_);
    return true;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double seconds_;
  const Progress& progress_;
};

/// Sets the number of threads for its lifetime.
class ThreadLimit {
 public:
  explicit ThreadLimit(std::size_t n) : before_(thread_count()) { set_thread_count(n); }
  ~ThreadLimit() { set_thread_count(before_); }
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  std::size_t before_;
};

/// @returns nothing if the method was ended before it was done.
std::optional<MethodRun> measure_method(const Scene& scene, const Variant& variant, const ColorOutput& output,
                                        double seconds) {
  MethodRun run;
  run.method = variant.method;
  run.variant = variant.name;
  BakedColors baked;
  const auto work = [&] { baked = variant.bake(scene, output); };
  const auto is_done = [&] { return !baked.certificate || !baked.certificate->is_out_of_time; };
  run.all_threads = measure_time(work, seconds / 2);
  if (!is_done()) return std::nullopt;
  {
    const ThreadLimit one(1);
    run.one_thread = measure_time(work, seconds / 2);
  }
  if (!is_done()) return std::nullopt;
  take_stored_colors(scene, output, baked);
  const Mesh& mesh = mesh_of(scene, baked);
  run.n_vertices = mesh.n_vertices();
  run.n_triangles = mesh.n_triangles();
  run.bytes = stored_bytes(mesh, bytes_of(variant.color));
  const SurfaceError error = surface_error(scene, baked, ErrorSpace::display);
  run.rmse = error.rmse;
  run.max_sampled = error.max_sampled;
  // An error that is known to be there needs no closer look.
  run.max_bound = bound_in_output(scene, output, ErrorSpace::display,
                                  certified_maximum(scene, baked, ErrorSpace::display, error.max_sampled));
  return run;
}

FrameRun measure_frame(const Scene& scene, const BakedColors& baked, const Camera& camera,
                       std::uint32_t width, std::uint32_t height, double seconds) {
  FrameRun run;
  run.width = width, run.height = height;
  Picture picture;
  const auto per_vertex = [&] { render_per_vertex(scene, baked, camera, width, height, picture); };
  const auto per_fragment = [&] {
    run.n_covered = render_per_fragment(scene, camera, width, height, picture);
  };
  run.per_vertex = measure_time(per_vertex, seconds / 4);
  run.per_fragment = measure_time(per_fragment, seconds / 4);
  const ThreadLimit one(1);
  run.per_vertex_one_thread = measure_time(per_vertex, seconds / 4);
  run.per_fragment_one_thread = measure_time(per_fragment, seconds / 4);
  return run;
}

/// `n` lamps on a sphere of 1.5 times the model's radius (a Fibonacci lattice), together as bright as one.
std::vector<Light> lamps_around(const Bounds& bounds, std::size_t n) {
  std::vector<Light> lights(n);
  const float distance = 1.5f * bounds.radius();
  for (std::size_t i = 0; i < n; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(n);
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / std::numbers::phi;
    const double r = std::sqrt(1 - z * z);
    Light& light = lights[i];
    light.type = LightType::point;
    light.position = bounds.center() + distance * glm::vec3(r * std::cos(angle), z, r * std::sin(angle));
    light.intensity = LinearRgb{1, 1, 1} * (distance * distance / static_cast<float>(n));
  }
  return lights;
}

LightsRun measure_lights(const Scene& scene, const Visibility& visibility, double seconds) {
  LightsRun run;
  run.n_lights = scene.lights.size();
  run.per_vertex = measure_time([&] { bake(scene, {.method = BakeMethod::sample}); }, seconds / 2);
  run.per_fragment = measure_time([&] { shade_per_fragment(scene, visibility); }, seconds / 2);
  return run;
}

}  // namespace

std::vector<std::string> chart_methods() {
  std::vector<std::string> names;
  for (const Variant& variant : variants(0))
    if (std::find(names.begin(), names.end(), variant.method) == names.end()) names.push_back(variant.method);
  return names;
}

ChartRun run_chart(const Scene& scene, const ChartRunOptions& options) {
  const std::vector<std::string> known = chart_methods();
  for (const std::string& name : options.methods)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw InvalidOption(
          fmt::format("chart: expected methods of {}, found \"{}\"", fmt::join(known, ", "), name));
  if (!(options.budget_seconds > 0))
    throw InvalidOption(
        fmt::format("chart: expected a budget above 0 seconds, found {}", options.budget_seconds));

  ChartRun run;
  run.n_vertices = scene.mesh.n_vertices();
  run.n_triangles = scene.mesh.n_triangles();
  run.n_lights = scene.lights.size();
  run.n_threads = thread_count();
  const Budget budget(options.budget_seconds, options.progress);
  // What the methods leave of their share the pictures may use, and the lights what both leave.
  constexpr double methods_until = 0.5, auto_until = 0.6, frames_until = 0.8;
  // For the repeats of each thing measured; errors, computed once, come on top.
  const double slice = options.budget_seconds / 80, frame_slice = options.budget_seconds / 20;

  const auto output_of = [&](ColorStorage color) {
    return options.output ? options.output(color) : ColorOutput{};
  };
  for (const Variant& variant : variants(options.budget_seconds / 8)) {
    const bool is_asked = options.methods.empty() || std::find(options.methods.begin(), options.methods.end(),
                                                               variant.method) != options.methods.end();
    if (!is_asked) continue;
    const std::string name = variant.method + (variant.name.empty() ? "" : ", " + variant.name);
    if (!budget.allows(name, methods_until, run.left_out)) continue;
    if (std::optional<MethodRun> method = measure_method(scene, variant, output_of(variant.color), slice))
      run.methods.push_back(std::move(*method));
    else
      run.left_out.push_back(name);
  }

  if (options.methods.empty() && budget.allows("auto", auto_until, run.left_out)) {
    const Selection selection = select_method(scene, {.tolerance = 1.0 / 255,
                                                      .max_seconds = options.budget_seconds / 8,
                                                      .output = output_of(ColorStorage::u16)});
    run.verdict = selection.sentence;
    run.chosen_method = name_of(selection.trials[selection.chosen].method);
  }

  const BakedColors baked = bake(scene, {.method = BakeMethod::sample});
  for (const auto& [width, height] :
       {std::pair<std::uint32_t, std::uint32_t>{640, 360}, {1280, 720}, {1920, 1080}, {3840, 2160}}) {
    const std::string name = fmt::format("picture of {}x{}", width, height);
    if (budget.allows(name, frames_until, run.left_out))
      run.frames.push_back(measure_frame(scene, baked, options.camera, width, height, frame_slice));
  }

  Scene lit = scene;
  const Bounds bounds = bounds_of(positions_in_faces(scene.mesh));
  const Visibility visibility = find_visibility(scene, scene.mesh, options.camera, 1280, 720);
  for (const std::size_t n : {1, 4, 16, 64, 256, 1024, 4096}) {
    if (!budget.allows(fmt::format("{} {}", n, in_number(n, "light[|s]")), 1, run.left_out)) continue;
    lit.lights = lamps_around(bounds, n);
    run.lights.push_back(measure_lights(lit, visibility, slice));
  }
  run.seconds = budget.spent();
  return run;
}

}  // namespace lambake
