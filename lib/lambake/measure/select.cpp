#include "lambake/measure/select.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "lambake/core/digits.h"
#include "lambake/measure/bound.h"
#include "lambake/measure/surface_error.h"

namespace lambake {
namespace {

/// An upper bound for people: no less than a hundredth of a step.
std::string steps(double error) {
  return std::isfinite(error) ? upper_bound_text(std::max(error * 255, 0.01)) + "/255" : "no bound";
}

std::size_t count_of(const BakedColors& baked, const char* code) {
  for (const Finding& finding : baked.findings)
    if (finding.code == code) return finding.count;
  return 0;
}

/// Whether the output has no room for some of the colours, by more than the tolerance: methods may leave
/// white by that. @param baked  as computed.
bool is_clipped(const Scene& scene, const BakeOptions& options, const BakedColors& baked) {
  const auto exceeds = [&](double color, double high) {
    if (color <= high) return false;
    const double of_white = color / high;
    return (options.tolerance_space == ErrorSpace::display ? srgb_encode(of_white) : of_white) - 1 >
           options.tolerance;
  };
  std::vector<ColorRange> ranges;
  for (const Material& material : scene.materials) ranges.push_back(stored_range(options.output, material));
  const std::vector<std::uint32_t> materials = vertex_materials(mesh_of(scene, baked));
  for (std::size_t v = 0; v < materials.size(); ++v) {
    const LinearRgb &c = baked.colors[v], &high = ranges[materials[v]].high;
    if (exceeds(c.r, high.r) || exceeds(c.g, high.g) || exceeds(c.b, high.b)) return true;
  }
  return false;
}

/// @param is_enough  Whether the chosen one's light is certified. @param is_clipped  Whether its colours are.
std::string verdict(const Selection& selection, const BakeOptions& options, std::size_t n_vertices,
                    bool is_enough, bool is_clipped) {
  const MethodTrial& best = selection.trials[selection.chosen];
  const std::string count = group_digits(best.n_vertices), asked = steps(options.tolerance);
  if (!options.output.gaps.empty()) {
    const Finding& gap = options.output.gaps.front();
    return fmt::format("nothing can be certified: {} {}; {} comes nearest, its light is {} {} off", gap.count,
                       gap.text, name_of(best.method), is_enough ? "at most" : "up to",
                       is_enough ? asked : steps(best.max_found));
  }
  if (selection.is_certified)
    return best.method == BakeMethod::adaptive
               ? fmt::format("{} → {} vertices for at most {} anywhere; per-pixel lighting is not needed",
                             group_digits(n_vertices), count, steps(best.max_bound))
               : fmt::format("{} suffices: at most {} anywhere", name_of(best.method), steps(best.max_bound));
  // Where what is left has another cause, light per pixel is not what is missing.
  const std::size_t n_open = selection.baked.certificate ? selection.baked.certificate->open_triangles : 0;
  const std::size_t n_by_storage = count_of(selection.baked, "triangles_open_by_storage");
  const char* cure = is_clipped ? "clips colours; a lower exposure helps" : "rounds colours; finer ones help";
  if (n_by_storage == n_open)
    return fmt::format("{} → {} vertices would do for {}, but up to {} are left as the output {}",
                       group_digits(n_vertices), count, asked, steps(best.max_bound), cure);
  if (2 * n_by_storage > n_open)
    return fmt::format(
        "not decided: {} vertices leave errors up to {} where {} is asked, but mostly as the output {}",
        count, steps(best.max_bound), asked, cure);
  if (2 * count_of(selection.baked, "triangles_without_direction") > n_open)
    return fmt::format(
        "not decided: {} vertices leave errors up to {} where {} is asked, but mostly where normals cancel "
        "and light per pixel has no direction either; --crease-angle-deg parts them",
        count, steps(best.max_bound), asked);
  const std::string left = std::isfinite(best.max_bound)
                               ? fmt::format("errors up to {}", steps(best.max_bound))
                               : "errors without a bound";
  if (selection.baked.certificate && selection.baked.certificate->is_out_of_time)
    return fmt::format(
        "not decided in {:g} s: {} vertices leave {} where {} is asked; with more time cutting goes on",
        options.max_seconds, count, left, asked);
  if (options.max_vertices > 0 && best.n_vertices >= options.max_vertices)
    return fmt::format(
        "not decided with at most {} vertices: {} leave {} where {} is asked; with more of them cutting goes "
        "on",
        group_digits(options.max_vertices), count, left, asked);
  return fmt::format("per-pixel lighting is needed: even {} vertices leave {} where {} is asked", count, left,
                     asked);
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
  std::vector<bool> is_enough;  // Of the trials, but for what the output has no place for.
  const auto is_better = [&](std::size_t i, std::size_t than) {
    if (is_enough[i] != is_enough[than]) return bool(is_enough[i]);
    const MethodTrial &a = selection.trials[i], &b = selection.trials[than];
    if (is_enough[i]) return a.bytes < b.bytes;
    return can_certify ? a.method == BakeMethod::adaptive : a.max_found < b.max_found;
  };
  for (const BakeMethod method :
       {BakeMethod::face, BakeMethod::sample, BakeMethod::least_squares, BakeMethod::adaptive}) {
    BakeOptions with = options;
    with.method = method;
    const auto start = std::chrono::steady_clock::now();
    BakedColors baked = bake(scene, with);
    MethodTrial trial;
    trial.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::vector<LinearRgb> computed = baked.colors;
    take_stored_colors(scene, options.output, baked);
    const Mesh& mesh = mesh_of(scene, baked);
    trial.method = method;
    trial.n_vertices = mesh.n_vertices();
    trial.n_triangles = mesh.n_triangles();
    trial.bytes = stored_bytes(mesh, 8);
    const SurfaceError error = surface_error(scene, baked, options.tolerance_space);
    trial.rmse = error.rmse;
    trial.max_found = error.max_sampled;
    const double light_bound = certified_maximum(scene, baked, options.tolerance_space, error.max_sampled);
    trial.max_bound = bound_in_output(scene, options.output, options.tolerance_space, light_bound);
    trial.is_certified = trial.max_bound <= options.tolerance;
    selection.trials.push_back(trial);
    is_enough.push_back(can_certify         ? trial.is_certified
                        : baked.certificate ? baked.certificate->open_triangles == 0
                                            : light_bound <= options.tolerance);
    if (is_enough.size() == 1 || is_better(is_enough.size() - 1, selection.chosen)) {
      selection.chosen = is_enough.size() - 1;
      selection.is_certified = trial.is_certified;
      baked.colors = std::move(computed);
      selection.baked = std::move(baked);
    }
    // What comes behind has as many vertices or more.
    if (method == BakeMethod::sample && is_enough.back()) break;
  }
  if (!can_certify && !selection.baked.certificate)
    selection.baked.findings.insert(selection.baked.findings.end(), options.output.gaps.begin(),
                                    options.output.gaps.end());
  selection.sentence = verdict(selection, options, scene.mesh.n_vertices(), is_enough[selection.chosen],
                               is_clipped(scene, options, selection.baked));
  return selection;
}

}  // namespace lambake
