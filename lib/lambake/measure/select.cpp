#include "lambake/measure/select.h"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cmath>
#include <tuple>

#include "lambake/core/digits.h"
#include "lambake/measure/bound.h"
#include "lambake/measure/surface_error.h"

namespace lambake {
namespace {

/// Position and normal as float, colour as u16 RGBA, three indices of 16 or 32 bit: as a GLB of one material
/// without textures.
std::size_t bytes_of(const Mesh& mesh) {
  const std::size_t index = mesh.n_vertices() < 65536 ? 2 : 4;
  return mesh.n_vertices() * (12 + 12 + 8) + mesh.n_triangles() * 3 * index;
}

std::string steps(double error) {
  return std::isfinite(error) ? fmt::format("{:.3g}/255", error * 255) : "no bound";
}

std::string verdict(const Selection& selection, const BakeOptions& options, std::size_t n_vertices) {
  const MethodTrial& best = selection.trials[selection.chosen];
  const std::string count = group_digits(best.n_vertices);
  // Where storage alone spoils the result, light per pixel is not what is missing.
  for (const Finding& finding : selection.baked.findings)
    if (finding.code == "triangles_open_by_storage" && selection.baked.certificate &&
        finding.count == selection.baked.certificate->open_triangles)
      return fmt::format(
          "{} → {} vertices would do for {}, but the output clips or rounds colours: up to {} off; "
          "a lower exposure or finer colours help",
          group_digits(n_vertices), count, steps(options.tolerance), steps(best.max_bound));
  if (!selection.is_certified)
    return fmt::format("per-pixel lighting is needed: even {} vertices leave up to {} where {} is asked",
                       count, steps(best.max_bound), steps(options.tolerance));
  if (best.method == BakeMethod::adaptive)
    return fmt::format("{} → {} vertices for at most {} anywhere; per-pixel lighting is not needed",
                       group_digits(n_vertices), count, steps(best.max_bound));
  return fmt::format("{} suffices: at most {} anywhere", name_of(best.method), steps(best.max_bound));
}

}  // namespace

std::string name_of(BakeMethod method) {
  switch (method) {
    case BakeMethod::face:
      return "face";
    case BakeMethod::sample:
      return "sample";
    case BakeMethod::average:
      return "average";
    case BakeMethod::least_squares:
      return "least-squares";
    case BakeMethod::uniform:
      return "uniform";
    case BakeMethod::adaptive:
      return "adaptive";
  }
  return "";
}

Selection select_method(const Scene& scene, const BakeOptions& options) {
  Selection selection;
  const auto cost = [](const MethodTrial& trial) {
    return std::make_tuple(!trial.is_certified, trial.bytes, trial.seconds);
  };
  for (const BakeMethod method :
       {BakeMethod::face, BakeMethod::sample, BakeMethod::least_squares, BakeMethod::adaptive}) {
    BakeOptions with = options;
    with.method = method;
    const auto start = std::chrono::steady_clock::now();
    BakedColors baked = bake(scene, with);
    MethodTrial trial;
    trial.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (options.as_stored && method != BakeMethod::adaptive)
      for (LinearRgb& c : baked.colors) c = options.as_stored(c);
    const Mesh& mesh = mesh_of(scene, baked);
    trial.method = method;
    trial.n_vertices = mesh.n_vertices();
    trial.n_triangles = mesh.n_triangles();
    trial.bytes = bytes_of(mesh);
    const SurfaceError error = surface_error(scene, baked, options.tolerance_space);
    trial.rmse = error.rmse;
    trial.max_found = error.max_sampled;
    trial.max_bound = certified_maximum(scene, baked, options.tolerance_space, error.max_sampled);
    trial.is_certified = trial.max_bound <= options.tolerance;
    selection.trials.push_back(trial);
    const bool is_last = method == BakeMethod::adaptive;
    const bool is_best =
        selection.trials.size() == 1 || cost(trial) < cost(selection.trials[selection.chosen]);
    if ((trial.is_certified && is_best) || (is_last && !selection.is_certified)) {
      selection.chosen = selection.trials.size() - 1;
      selection.is_certified = trial.is_certified;
      selection.baked = std::move(baked);
    }
  }
  selection.sentence = verdict(selection, options, scene.mesh.n_vertices());
  return selection;
}

}  // namespace lambake
