#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "lambake/bake/balance.h"
#include "lambake/bake/cut_bounds.h"
#include "lambake/bake/cut_colors.h"
#include "lambake/bake/cut_search.h"
#include "lambake/bake/deadline.h"
#include "lambake/bake/methods.h"
#include "lambake/bake/vanishing_normals.h"
#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/geometry/cutting.h"
#include "lambake/shading/finish.h"
#include "lambake/shading/patch_bound.h"

namespace lambake {
namespace {

constexpr std::size_t block_size = 64;

/// Rounds of cutting. Each halves at least a side of what is left, so that this many are only needed around
/// a light on the surface, where no mesh is fine enough.
constexpr int max_rounds = 24;

/// Rounds after which sides are no longer spared: most scenes need fewer.
constexpr int n_sparing_rounds = 8;

/// Errors up to this multiple of the tolerance are left to balancing, which halves those of one sign.
constexpr double left_to_balancing = 1.9;

/// Balancing moves errors to this share of the tolerance: more would be hard to certify, less leaves more to
/// be cut. Measured on scans between 0.9 and 0.97.
constexpr double balanced_share = 0.94;
constexpr int balancing_passes = 2;

/// Enclosures computed while the worst place of a triangle is searched for balancing.
constexpr int max_parts_of_search = 100;

class AdaptiveBake {
 public:
  AdaptiveBake(const Scene& scene, const BakeOptions& options)
      : scene_(scene),
        options_(options),
        cut_(scene.mesh),
        colors_(scene, options, cut_),
        finishes_(scene),
        deadline_(options.max_seconds),
        bounds_(scene, options, cut_, colors_, finishes_, deadline_),
        search_(scene, options, cut_, colors_, finishes_, bounds_, deadline_),
        left_by_rounding_(options.tolerance - colors_.rounding()) {}

  BakedColors run() {
    BakedColors baked;
    const double smallest_angle_before = smallest_angle();
    cut_until(colors_.rounding() + left_to_balancing * left_by_rounding_);
    bounds_.update(bounds_.above(options_.tolerance), options_.tolerance);
    for (int pass = 0; pass < balancing_passes && !deadline_.is_past(); ++pass) balance();
    cut_until(options_.tolerance);
    const std::size_t n_spoilt = take_stored_colors();
    bounds_.update_closely(bounds_.above(options_.tolerance));

    baked.certificate = certificate();
    baked.certificate->smallest_angle_before = smallest_angle_before;
    baked.findings = findings(baked.certificate->open_triangles, n_spoilt);
    baked.colors = colors_.take_colors();
    baked.cuts = cut_.take_cuts();
    baked.parent_triangles = cut_.take_parent_triangles();
    baked.mesh = cut_.take_mesh();
    return baked;
  }

 private:
  /// Cuts until no triangle is above `level`, or it may not go on.
  void cut_until(double level) {
    std::vector<std::uint32_t> active = bounds_.above(level);
    for (int round = 0;; ++round) {
      bounds_.update(active, level);
      if (round == n_sparing_rounds && level == options_.tolerance) active = unbalance();
      if (round == max_rounds || !search_.has_room() || deadline_.is_past()) return;
      const std::vector<CutMark> marks = search_.find_marks(active, level, round >= n_sparing_rounds);
      if (marks.empty()) return;
      report_progress(options_.progress, "cutting", static_cast<double>(round) / max_rounds);
      active = apply(marks);
    }
  }

  /// Moves the colours around the triangles above the tolerance, where that mends them.
  void balance() {
    const std::vector<std::uint32_t> open = bounds_.above(options_.tolerance);
    std::vector<glm::dmat3> shifts(open.size());
    BoundOptions how;
    how.space = options_.tolerance_space;
    how.accept = options_.tolerance;
    how.tightness = 1.2;
    how.max_parts = max_parts_of_search;
    parallel_blocks(open.size(), block_size, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> lights;
      for (std::size_t i = begin; i < end; ++i) {
        const glm::uvec3& t = cut_.mesh().triangles[open[i]];
        const Patch patch = colors_.patch(t);
        const FinishRange finish = finishes_.over(cut_.mesh(), open[i]);
        find_reaching_lights(scene_.lights, patch, lights);
        const PatchBound known = bound_patch(patch, finish, scene_.lights, lights, how);
        glm::dmat3 exact;
        for (int c = 0; c < 3; ++c) {
          const LinearRgb& e = colors_.exact(t[c]);
          exact[c] = {e.r, e.g, e.b};
        }
        shifts[i] = balancing_shifts(patch, exact, finish, scene_.lights, lights, known.found_at,
                                     balanced_share * left_by_rounding_, options_.tolerance_space);
      }
    });
    for (std::size_t i = 0; i < open.size(); ++i)
      for (int c = 0; c < 3; ++c) colors_.ask(cut_.mesh().triangles[open[i]][c], glm::vec3(shifts[i][c]));
    bounds_.update(triangles_with(colors_.move_asked()), options_.tolerance);
  }

  /// The colours around the triangles above the tolerance go back to the reference: what a balanced vertex
  /// has itself no cut takes away, where a texture leaves the bound no room for it.
  /// @returns the triangles that are above the tolerance now.
  std::vector<std::uint32_t> unbalance() {
    std::vector<char> is_marked_place(cut_.n_places(), 0);
    for (const std::uint32_t f : bounds_.above(options_.tolerance))
      for (int c = 0; c < 3; ++c) is_marked_place[cut_.places()[cut_.mesh().triangles[f][c]]] = 1;
    bounds_.update(triangles_with(colors_.move_back(is_marked_place)), options_.tolerance);
    return bounds_.above(options_.tolerance);
  }

  /// The triangles with a vertex that is marked, ascending.
  std::vector<std::uint32_t> triangles_with(const std::vector<char>& is_marked) const {
    std::vector<std::uint32_t> touched;
    for (std::uint32_t f = 0; f < cut_.mesh().n_triangles(); ++f) {
      const glm::uvec3& t = cut_.mesh().triangles[f];
      if (is_marked[t[0]] || is_marked[t[1]] || is_marked[t[2]]) touched.push_back(f);
    }
    return touched;
  }

  /// What is certified is what is stored. @returns how many triangles come to be above the tolerance by that.
  std::size_t take_stored_colors() {
    std::vector<char> is_spoilt(cut_.mesh().n_vertices());
    for (std::uint32_t v = 0; v < is_spoilt.size(); ++v) is_spoilt[v] = colors_.is_spoilt(v);
    const std::vector<std::uint32_t> spoilt = triangles_with(is_spoilt);
    const std::vector<double> before = bounds_.values();
    colors_.take_stored();
    bounds_.update(spoilt, options_.tolerance);
    return static_cast<std::size_t>(std::count_if(spoilt.begin(), spoilt.end(), [&](std::uint32_t f) {
      return before[f] <= options_.tolerance && bounds_.values()[f] > options_.tolerance;
    }));
  }

  std::size_t n_moved() const {
    const std::vector<std::uint32_t> open = bounds_.above(options_.tolerance);
    return static_cast<std::size_t>(std::count_if(open.begin(), open.end(), [&](std::uint32_t f) {
      return std::isfinite(bounds_.values()[f]) && bounds_.is_rounded_too_far(f, options_.tolerance);
    }));
  }

  std::size_t n_without_direction() const {
    const std::vector<std::uint32_t> open = bounds_.above(options_.tolerance);
    return static_cast<std::size_t>(std::count_if(
        open.begin(), open.end(), [&](std::uint32_t f) { return !has_direction(cut_, scene_.mesh, f); }));
  }

  Certificate certificate() const {
    Certificate certificate;
    certificate.space = options_.tolerance_space;
    certificate.smallest_angle_after = smallest_angle();
    certificate.open_triangles = bounds_.above(options_.tolerance).size();
    for (const double b : bounds_.values()) certificate.max_bound = std::max(certificate.max_bound, b);
    certificate.max_bound =
        bound_in_output(scene_, options_.output, options_.tolerance_space, certificate.max_bound);
    certificate.is_certified = certificate.open_triangles == 0 && certificate.max_bound <= options_.tolerance;
    certificate.is_out_of_time = deadline_.is_past() && !certificate.is_certified;
    return certificate;
  }

  /// @param n_open    triangles above the tolerance. @param n_spoilt  those by what the output makes of
  /// colours.
  std::vector<Finding> findings(std::size_t n_open, std::size_t n_spoilt) const {
    std::vector<Finding> findings;
    const auto& bounds = bounds_.values();
    const auto n_unbounded = static_cast<std::size_t>(
        std::count_if(bounds.begin(), bounds.end(), [](double b) { return !std::isfinite(b); }));
    if (deadline_.is_past())
      add_finding(findings, "triangles_not_bounded", n_unbounded,
                  "triangle[ has|s have] no bound: the time was up, or a light touches [it|them]");
    else
      add_finding(findings, "unbounded_triangles", n_unbounded,
                  "triangle[ is|s are] touched by a light, so that the error there has no bound");
    const char* const why = deadline_.is_past()   ? ": the time was up"
                            : !search_.has_room() ? ": no more vertices may be made (--max-vertices)"
                                                  : "";
    add_finding(findings, "open_triangles", n_open - n_unbounded,
                std::string("triangle[ is|s are] not certified to be within the tolerance") + why);
    add_finding(
        findings, "triangles_open_by_position", n_moved(),
        "of them ha[s|ve] corners that cuts made and that float rounds too far for [it|them]: "
        "[it is a sliver|they are slivers], or the model or its texture coordinates are far from the origin");
    add_finding(
        findings, "triangles_without_direction", n_without_direction(),
        "of them ha[s|ve] normals that cancel inside or at a corner: light per pixel has no direction there "
        "either; --crease-angle-deg parts such normals");
    add_finding(
        findings, "triangles_open_by_storage", n_spoilt,
        "of them would be, but for what the output clips or rounds: a lower exposure or finer colours "
        "help there, cutting does not");
    const std::vector<double> emitted =
        errors_without_light(scene_, options_.output, options_.tolerance_space);
    add_finding(findings, "emission_open_by_storage",
                static_cast<std::size_t>(std::count_if(emitted.begin(), emitted.end(),
                                                       [&](double e) { return e > options_.tolerance; })),
                "material[ of base colour 0 emits|s of base colour 0 emit] what the output clips or rounds "
                "by more than the tolerance");
    findings.insert(findings.end(), options_.output.gaps.begin(), options_.output.gaps.end());
    return findings;
  }

  std::vector<std::uint32_t> apply(const std::vector<CutMark>& marks) {
    cut_.make_vertices(marks);
    colors_.add_new_vertices();
    FinishRange plain;
    // Of two diagonals the one that shows less; if that is little, the one that leaves no slivers.
    std::vector<std::uint32_t> changed =
        cut_.split([&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
          const double ac = search_.error_between(a, c, plain).error,
                       bd = search_.error_between(b, d, plain).error;
          if (std::max(ac, bd) > 0.25 * options_.tolerance) return ac < bd;
          return std::min(sharpest_corner({a, b, c}), sharpest_corner({a, c, d})) >
                 std::min(sharpest_corner({a, b, d}), sharpest_corner({b, c, d}));
        });
    bounds_.add_new_triangles();
    return changed;
  }

  /// The smallest angle of a triangle in radians; π/3 if it has no area.
  double sharpest_corner(const glm::uvec3& t) const {
    double smallest = std::numbers::pi / 3;
    for (int c = 0; c < 3; ++c) {
      const glm::dvec3 p = cut_.positions()[t[c]], a = cut_.positions()[t[(c + 1) % 3]] - p,
                       b = cut_.positions()[t[(c + 2) % 3]] - p;
      const double sine = glm::length(glm::cross(a, b));
      if (sine > 0 && std::isfinite(sine)) smallest = std::min(smallest, std::atan2(sine, glm::dot(a, b)));
    }
    return smallest;
  }

  double smallest_angle() const {
    double smallest = std::numbers::pi / 3;
    for (const glm::uvec3& t : cut_.mesh().triangles) smallest = std::min(smallest, sharpest_corner(t));
    return smallest;
  }

  const Scene& scene_;
  const BakeOptions& options_;
  CutMesh cut_;
  CutColors colors_;
  Finishes finishes_;
  Deadline deadline_;
  CutBounds bounds_;
  CutSearch search_;
  double left_by_rounding_;  ///< What the output's rounding leaves of the tolerance.
};

}  // namespace

BakedColors bake_adaptive(const Scene& scene, const BakeOptions& options) {
  if (scene.mesh.normals.size() != scene.mesh.n_vertices())
    throw InvalidScene(fmt::format("bake: expected {} vertex normals, found {}", scene.mesh.n_vertices(),
                                   scene.mesh.normals.size()));
  if (!(options.tolerance > 0)) throw InvalidOption("bake: expected a tolerance above 0");
  return AdaptiveBake(scene, options).run();
}

}  // namespace lambake
