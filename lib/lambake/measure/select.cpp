#include "lambake/measure/select.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "lambake/core/digits.h"
#include "lambake/measure/bound.h"
#include "lambake/measure/surface_error.h"

namespace lambake {
namespace {

std::string steps(double error) {
  return std::isfinite(error) ? upper_bound_text(error * 255) + "/255" : "no bound";
}

/// Triangles that only storage keeps from being certified.
std::size_t open_by_storage(const BakedColors& baked) {
  for (const Finding& finding : baked.findings)
    if (finding.code == "triangles_open_by_storage") return finding.count;
  return 0;
}

std::string verdict(const Selection& selection, const BakeOptions& options, std::size_t n_vertices) {
  const MethodTrial& best = selection.trials[selection.chosen];
  const std::string count = group_digits(best.n_vertices);
  if (!options.output.gaps.empty()) {
    const Finding& gap = options.output.gaps.front();
    return fmt::format("nothing can be certified: {} {}; {} comes nearest, its light is up to {} off",
                       gap.count, gap.text, name_of(best.method), steps(best.max_found));
  }
  // Where storage alone spoils the result, light per pixel is not what is missing.
  if (!selection.is_certified && selection.baked.certificate &&
      open_by_storage(selection.baked) == selection.baked.certificate->open_triangles)
    return fmt::format(
        "{} → {} vertices would do for {}, but the output clips or rounds colours: up to {} off; "
        "a lower exposure or finer colours help",
        group_digits(n_vertices), count, steps(options.tolerance), steps(best.max_bound));
  if (!selection.is_certified && selection.baked.certificate &&
      2 * open_by_storage(selection.baked) > selection.baked.certificate->open_triangles)
    return fmt::format(
        "not decided: {} vertices leave errors up to {} where {} is asked, but mostly as the output clips or "
        "rounds colours; a lower exposure or finer colours help",
        count, steps(best.max_bound), steps(options.tolerance));
  const std::string left = std::isfinite(best.max_bound)
                               ? fmt::format("errors up to {}", steps(best.max_bound))
                               : "errors without a bound";
  if (!selection.is_certified && selection.baked.certificate && selection.baked.certificate->is_out_of_time)
    return fmt::format(
        "not decided in {:g} s: {} vertices leave {} where {} is asked; with more time cutting goes on",
        options.max_seconds, count, left, steps(options.tolerance));
  if (!selection.is_certified)
    return fmt::format("per-pixel lighting is needed: even {} vertices leave {} where {} is asked", count,
                       left, steps(options.tolerance));
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

std::size_t stored_bytes(const Mesh& mesh, std::size_t color_bytes) {
  const std::size_t index_bytes = mesh.n_vertices() < 65536 ? 2 : 4;
  return mesh.n_vertices() * (12 + 12 + color_bytes) + mesh.n_triangles() * 3 * index_bytes;
}

Selection select_method(const Scene& scene, const BakeOptions& options) {
  Selection selection;
  const bool can_certify = options.output.gaps.empty();
  std::vector<BakeMethod> methods = {BakeMethod::face, BakeMethod::sample, BakeMethod::least_squares};
  if (can_certify) methods.push_back(BakeMethod::adaptive);
  const auto is_better = [&](const MethodTrial& trial, const MethodTrial& than) {
    if (!can_certify) return trial.max_found < than.max_found;
    if (trial.is_certified && than.is_certified) return trial.bytes < than.bytes;
    return trial.is_certified || (!than.is_certified && trial.method == BakeMethod::adaptive);
  };
  for (const BakeMethod method : methods) {
    BakeOptions with = options;
    with.method = method;
    const auto start = std::chrono::steady_clock::now();
    BakedColors baked = bake(scene, with);
    MethodTrial trial;
    trial.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (method != BakeMethod::adaptive) take_stored_colors(scene, options.output, baked);
    const Mesh& mesh = mesh_of(scene, baked);
    trial.method = method;
    trial.n_vertices = mesh.n_vertices();
    trial.n_triangles = mesh.n_triangles();
    trial.bytes = stored_bytes(mesh, 8);
    const SurfaceError error = surface_error(scene, baked, options.tolerance_space);
    trial.rmse = error.rmse;
    trial.max_found = error.max_sampled;
    trial.max_bound =
        bound_in_output(scene, options.output, options.tolerance_space,
                        certified_maximum(scene, baked, options.tolerance_space, error.max_sampled));
    trial.is_certified = trial.max_bound <= options.tolerance;
    selection.trials.push_back(trial);
    if (selection.trials.size() == 1 || is_better(trial, selection.trials[selection.chosen])) {
      selection.chosen = selection.trials.size() - 1;
      selection.is_certified = trial.is_certified;
      selection.baked = std::move(baked);
    }
    // What comes behind has as many vertices or more.
    if (method == BakeMethod::sample && can_certify && trial.is_certified) break;
  }
  if (!can_certify)
    selection.baked.findings.insert(selection.baked.findings.end(), options.output.gaps.begin(),
                                    options.output.gaps.end());
  selection.sentence = verdict(selection, options, scene.mesh.n_vertices());
  return selection;
}

}  // namespace lambake
