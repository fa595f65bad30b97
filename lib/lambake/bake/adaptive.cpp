#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <vector>

#include "lambake/bake/balance.h"
#include "lambake/bake/cut_colors.h"
#include "lambake/bake/methods.h"
#include "lambake/bake/side_error.h"
#include "lambake/core/bounds.h"
#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/geometry/cutting.h"
#include "lambake/shading/finish.h"
#include "lambake/shading/moved_corners.h"
#include "lambake/shading/patch_bound.h"

namespace lambake {
namespace {

constexpr std::size_t block_size = 64;
constexpr double infinity = std::numeric_limits<double>::infinity();

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

/// Enclosures computed for a triangle at most, and while its worst place is searched: a cut is the better way
/// to go on.
constexpr int max_parts = 400, max_parts_of_search = 100;

/// A cut this near to an end leaves a sliver and no gain.
constexpr double nearest_cut = 1e-4;

/// Sides shorter than this share of the largest coordinate are not cut: positions in float, which have 2^-24
/// of it, would hardly carry it.
constexpr double shortest_share = 1e-6;

/// Around a place where the interpolated normal vanishes, its direction turns by the same angles at every
/// scale: cutting would not end. In a triangle of the scene whose normal gets as short as the first of these,
/// parts whose normals are all shorter than the second are left alone.
constexpr double vanishing_normal = 0.05, short_normal = 0.25;

/// The distance of the triangle a b c from the origin.
double distance_from_origin(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const auto to_side = [](const glm::dvec3& p, const glm::dvec3& q) {
    const glm::dvec3 d = q - p;
    const double square = glm::dot(d, d);
    const double t = square > 0 ? std::clamp(-glm::dot(p, d) / square, 0.0, 1.0) : 0;
    return glm::length(p + t * d);
  };
  const double nearest = std::min({to_side(a, b), to_side(b, c), to_side(c, a)});
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double square = glm::dot(normal, normal);
  if (!(square > 0)) return nearest;
  const glm::dvec3 foot = normal * (glm::dot(a, normal) / square);
  const auto is_inside = [&](const glm::dvec3& p, const glm::dvec3& q) {
    return glm::dot(glm::cross(q - p, foot - p), normal) >= 0;
  };
  return is_inside(a, b) && is_inside(b, c) && is_inside(c, a) ? glm::length(foot) : nearest;
}

double largest_coordinate(const Mesh& mesh) {
  const Bounds box = bounds_of(mesh.positions);
  const glm::vec3 size = glm::max(glm::abs(box.min), glm::abs(box.max));
  return std::max({size.x, size.y, size.z});
}

class AdaptiveBake {
 public:
  AdaptiveBake(const Scene& scene, const BakeOptions& options)
      : scene_(scene),
        options_(options),
        cut_(scene.mesh),
        colors_(scene, options, cut_),
        finishes_(scene),
        bounds_(scene.mesh.n_triangles(), infinity),
        max_vertices_(options.max_vertices > 0 ? options.max_vertices : 8 * scene.mesh.n_vertices() + 65536),
        left_by_rounding_(options.tolerance - colors_.rounding()),
        shortest_side_(shortest_share * largest_coordinate(scene.mesh)) {}

  BakedColors run() {
    BakedColors baked;
    Certificate& certificate = baked.certificate.emplace();
    certificate.space = options_.tolerance_space;
    certificate.smallest_angle_before = smallest_angle();
    cut_until(colors_.rounding() + left_to_balancing * left_by_rounding_);
    bound(above(options_.tolerance), options_.tolerance);
    for (int pass = 0; pass < balancing_passes && !is_late(); ++pass) balance();
    cut_until(options_.tolerance);
    const std::size_t n_spoilt = take_stored_colors();
    bound_closely(above(options_.tolerance));

    certificate.smallest_angle_after = smallest_angle();
    std::size_t unbounded = 0;
    for (const double b : bounds_) {
      certificate.max_bound = std::max(certificate.max_bound, b);
      certificate.open_triangles += b > options_.tolerance;
      unbounded += !std::isfinite(b);
    }
    certificate.max_bound =
        bound_in_output(scene_, options_.output, options_.tolerance_space, certificate.max_bound);
    certificate.is_certified = certificate.open_triangles == 0 && certificate.max_bound <= options_.tolerance;
    certificate.is_out_of_time = is_late() && !certificate.is_certified;
    if (is_late())
      add_finding(baked.findings, "triangles_not_bounded", unbounded,
                  "triangle[ has|s have] no bound: the time was up, or a light touches [it|them]");
    else
      add_finding(baked.findings, "unbounded_triangles", unbounded,
                  "triangle[ is|s are] touched by a light, so that the error there has no bound");
    add_finding(baked.findings, "open_triangles", certificate.open_triangles - unbounded,
                "triangle[ is|s are] not certified to be within the tolerance");
    add_finding(baked.findings, "triangles_open_by_position", n_moved(),
                "of them ha[s|ve] corners that cuts made and that float rounds too far for [it|them]: "
                "[it is a sliver|they are slivers], or the model is far from the origin");
    add_finding(
        baked.findings, "triangles_without_direction", n_without_direction(),
        "of them ha[s|ve] normals that cancel inside or at a corner: light per pixel has no direction there "
        "either; --crease-angle-deg parts such normals");
    add_finding(
        baked.findings, "triangles_open_by_storage", n_spoilt,
        "of them would be, but for what the output clips or rounds: a lower exposure or finer colours "
        "help there, cutting does not");
    const std::vector<double> emitted =
        errors_without_light(scene_, options_.output, options_.tolerance_space);
    add_finding(baked.findings, "emission_open_by_storage",
                static_cast<std::size_t>(std::count_if(emitted.begin(), emitted.end(),
                                                       [&](double e) { return e > options_.tolerance; })),
                "material[ of base colour 0 emits|s of base colour 0 emit] what the output clips or rounds "
                "by more than the tolerance");
    baked.findings.insert(baked.findings.end(), options_.output.gaps.begin(), options_.output.gaps.end());
    baked.colors = colors_.take_colors();
    baked.cuts = cut_.cuts();
    baked.parent_triangles = cut_.parent_triangles();
    baked.mesh = cut_.take_mesh();
    return baked;
  }

 private:
  bool is_late() const {
    if (options_.max_seconds <= 0) return false;
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
    return elapsed.count() > options_.max_seconds;
  }

  /// The triangles with a bound above `level`, ascending.
  std::vector<std::uint32_t> above(double level) const {
    std::vector<std::uint32_t> triangles;
    for (std::uint32_t f = 0; f < bounds_.size(); ++f)
      if (bounds_[f] > level) triangles.push_back(f);
    return triangles;
  }

  /// Cuts until no triangle is above `level`, or it may not go on.
  void cut_until(double level) {
    std::vector<std::uint32_t> active = above(level);
    for (int round = 0;; ++round) {
      bound(active, level);
      if (round == n_sparing_rounds && level == options_.tolerance) active = unbalance();
      if (round == max_rounds || !has_room_ || is_late()) return;
      const std::vector<CutMark> marks = find_marks(active, level, round >= n_sparing_rounds);
      if (marks.empty()) return;
      report_progress(options_.progress, "cutting", static_cast<double>(round) / max_rounds);
      active = apply(marks);
    }
  }

  /// Moves the colours around the triangles above the tolerance, where that mends them.
  void balance() {
    const std::vector<std::uint32_t> open = above(options_.tolerance);
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
    bound(triangles_with(colors_.move_asked()), options_.tolerance);
  }

  /// The colours around the triangles above the tolerance go back to the reference: what a balanced vertex
  /// has itself no cut takes away, where a texture leaves the bound no room for it.
  /// @returns the triangles that are above the tolerance now.
  std::vector<std::uint32_t> unbalance() {
    std::vector<char> is_marked_place(cut_.n_places(), 0);
    for (const std::uint32_t f : above(options_.tolerance))
      for (int c = 0; c < 3; ++c) is_marked_place[cut_.places()[cut_.mesh().triangles[f][c]]] = 1;
    bound(triangles_with(colors_.move_back(is_marked_place)), options_.tolerance);
    return above(options_.tolerance);
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
    const std::vector<double> before = bounds_;
    colors_.take_stored();
    bound(spoilt, options_.tolerance);
    return static_cast<std::size_t>(std::count_if(spoilt.begin(), spoilt.end(), [&](std::uint32_t f) {
      return before[f] <= options_.tolerance && bounds_[f] > options_.tolerance;
    }));
  }

  std::size_t n_moved() const {
    std::size_t n = 0;
    for (std::uint32_t f = 0; f < bounds_.size(); ++f)
      n += bounds_[f] > options_.tolerance && std::isfinite(bounds_[f]) &&
           is_rounded_too_far(f, options_.tolerance);
    return n;
  }

  std::size_t n_without_direction() const {
    std::size_t n = 0;
    for (std::uint32_t f = 0; f < bounds_.size(); ++f)
      n += bounds_[f] > options_.tolerance && !has_direction(f);
    return n;
  }

  /// Certified bounds of the triangles, no better than `level` needs; none once it is late.
  void bound(const std::vector<std::uint32_t>& triangles, double level) {
    const BoundOptions how{.space = options_.tolerance_space,
                           .accept = level,
                           .reject = level,
                           .tightness = 1,
                           .max_parts = max_parts};
    parallel_blocks(triangles.size(), block_size, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> lights;
      for (std::size_t i = begin; i < end; ++i)
        bounds_[triangles[i]] = is_late() ? infinity : bound_of(triangles[i], how, lights);
    });
  }

  /// Bounds near the truth, for what is told of triangles that stay open: bound() leaves them where it has
  /// found an error above the level.
  void bound_closely(const std::vector<std::uint32_t>& triangles) {
    const BoundOptions how{.space = options_.tolerance_space};
    parallel_blocks(triangles.size(), block_size, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> lights;
      for (std::size_t i = begin; i < end && !is_late(); ++i) {
        double& known = bounds_[triangles[i]];
        if (std::isfinite(known)) known = std::min(known, bound_of(triangles[i], how, lights));
      }
    });
  }

  /// @param how  levels with what the rounding of corners adds. @param lights  room to work in.
  double bound_of(std::uint32_t f, BoundOptions how, std::vector<std::uint32_t>& lights) const {
    const Patch patch = colors_.patch(cut_.mesh().triangles[f]);
    if (area_of(patch) == 0) return 0;
    find_reaching_lights(scene_.lights, patch, lights);
    const FinishRange finish = finishes_.over(cut_.mesh(), f);
    const double moved = change_by_rounding(f, patch, finish);
    for (double* level : {&how.accept, &how.reject}) *level = std::max(*level - moved, 0.5 * *level);
    const double known = bound_patch(patch, finish, scene_.lights, lights, how).bound;
    return bound_with_change(known, moved, options_.tolerance_space);
  }

  /// What the colours of a triangle change because its corners are stored as float.
  double change_by_rounding(std::uint32_t f, const Patch& patch, const FinishRange& finish) const {
    const glm::uvec3& t = cut_.mesh().triangles[f];
    const auto stored = [&](int c) { return glm::dvec3(cut_.mesh().positions[t[c]]); };
    return change_by_moved_corners(patch, finish, {stored(0), stored(1), stored(2)},
                                   options_.tolerance_space);
  }

  /// Whether the rounding of a triangle's corners takes half of `level`: no cut mends that.
  bool is_rounded_too_far(std::uint32_t f, double level) const {
    return change_by_rounding(f, colors_.patch(cut_.mesh().triangles[f]), finishes_.over(cut_.mesh(), f)) >
           0.5 * level;
  }

  /// The error along the side between the vertices a and b; t from the lower place to the higher.
  SideError error_between(std::uint32_t a, std::uint32_t b, const FinishRange& finish) const {
    if (cut_.places()[a] > cut_.places()[b]) std::swap(a, b);
    const Patch patch = colors_.patch({a, b, b});
    std::vector<std::uint32_t> lights;
    find_reaching_lights(scene_.lights, patch, lights);
    return side_error(patch, finish, scene_.lights, lights, options_.tolerance_space);
  }

  /// Where to cut for the triangles of `active` that are above `level`: every side with an error above it,
  /// which no other cut can mend, or else the worst side. With `is_thorough` also those whose error bulges by
  /// half of it: spared sides of needles can leave cuts beside them without effect.
  std::vector<CutMark> find_marks(const std::vector<std::uint32_t>& active, double level, bool is_thorough) {
    std::vector<std::uint32_t> open;
    for (const std::uint32_t f : active)
      if (bounds_[f] > level && has_direction(f) && !is_rounded_too_far(f, level)) open.push_back(f);
    struct Candidate {
      std::uint32_t low = 0, high = 0;
      double error = -1, t = 0;
    };
    std::vector<std::array<Candidate, 3>> found(open.size());
    parallel_blocks(open.size(), block_size, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end && !is_late(); ++i) {
        const FinishRange finish = finishes_.over(cut_.mesh(), open[i]);
        const glm::uvec3& t = cut_.mesh().triangles[open[i]];
        std::array<double, 3> merit{}, bulges{};
        glm::dvec3 lengths;
        for (int k = 0; k < 3; ++k)
          lengths[k] = glm::length(cut_.positions()[t[(k + 1) % 3]] - cut_.positions()[t[k]]);
        const double longest = std::max({lengths[0], lengths[1], lengths[2]});
        for (int k = 0; k < 3; ++k) {
          const std::uint32_t a = t[k], b = t[(k + 1) % 3];
          const SideError side = error_between(a, b, finish);
          bulges[static_cast<std::size_t>(k)] = side.bulge;
          const auto [low, high] = std::minmax(cut_.places()[a], cut_.places()[b]);
          found[i][static_cast<std::size_t>(k)] = {low, high, side.error,
                                                   side.bulge > 0.05 * level ? side.t : 0.5};
          // Where no side is above the tolerance: the worst, but no short side of a sliver; where none shows
          // an error at all, the one along which the normal and the position turn most.
          merit[static_cast<std::size_t>(k)] =
              (side.error + 1e-3 * level * bend(a, b)) * (0.1 + lengths[k] / longest);
        }
        const auto worst =
            static_cast<std::size_t>(std::max_element(merit.begin(), merit.end()) - merit.begin());
        for (std::size_t k = 0; k < 3; ++k) {
          Candidate& c = found[i][k];
          const bool is_needed = c.error > level || k == worst ||
                                 (is_thorough && bulges[static_cast<std::size_t>(k)] > 0.5 * level);
          const bool is_too_short = !(lengths[static_cast<int>(k)] > shortest_side_);
          if (!is_needed || c.low == c.high || is_too_short) c.error = -1;
        }
      }
    });
    std::vector<Candidate> candidates;
    for (const auto& sides : found)
      for (const Candidate& c : sides)
        if (c.error >= 0) candidates.push_back(c);
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& x, const Candidate& y) {
      return std::tie(x.low, x.high, y.error, x.t) < std::tie(y.low, y.high, x.error, y.t);
    });
    candidates.erase(std::unique(candidates.begin(), candidates.end(),
                                 [](const Candidate& x, const Candidate& y) {
                                   return x.low == y.low && x.high == y.high;
                                 }),
                     candidates.end());
    // A mark makes a vertex for each pair of copies of its ends that has a side, so at most for all pairs.
    const std::size_t n = cut_.mesh().n_vertices();
    const std::size_t room = max_vertices_ > n ? max_vertices_ - n : 0;
    const std::vector<std::uint32_t> copies = copies_of_places();
    const auto n_made = [&](const Candidate& c) { return std::size_t(copies[c.low]) * copies[c.high]; };
    std::size_t n_all = 0;
    for (const Candidate& c : candidates) n_all += n_made(c);
    if (n_all > room) {
      has_room_ = false;
      std::stable_sort(candidates.begin(), candidates.end(),
                       [](const Candidate& x, const Candidate& y) { return x.error > y.error; });
      std::size_t n_kept = 0, n_taken = 0;
      while (n_kept < candidates.size() && n_taken + n_made(candidates[n_kept]) <= room)
        n_taken += n_made(candidates[n_kept++]);
      candidates.resize(n_kept);
    }
    std::vector<CutMark> marks;
    marks.reserve(candidates.size());
    for (const Candidate& c : candidates)
      marks.push_back({c.low, c.high, static_cast<float>(std::clamp(c.t, nearest_cut, 1 - nearest_cut))});
    return marks;
  }

  /// How many vertices are at each place.
  std::vector<std::uint32_t> copies_of_places() const {
    std::vector<std::uint32_t> copies;
    for (const std::uint32_t place : cut_.places()) {
      if (place >= copies.size()) copies.resize(place + 1, 0);
      ++copies[place];
    }
    return copies;
  }

  bool has_direction(std::uint32_t f) const {
    const glm::uvec3& t = cut_.mesh().triangles[f];
    const glm::dvec3 &a = cut_.normals()[t[0]], &b = cut_.normals()[t[1]], &c = cut_.normals()[t[2]];
    if (std::max({glm::length(a), glm::length(b), glm::length(c)}) >= short_normal) return true;
    const glm::uvec3& whole = scene_.mesh.triangles[cut_.parent_triangles()[f]];
    const auto normal = [&](int k) { return glm::dvec3(scene_.mesh.normals[whole[k]]); };
    return distance_from_origin(normal(0), normal(1), normal(2)) > vanishing_normal;
  }

  /// A measure of how much the light can vary between two vertices.
  double bend(std::uint32_t a, std::uint32_t b) const {
    const glm::dvec3 dn = cut_.normals()[a] - cut_.normals()[b];
    const glm::dvec3 dp = cut_.positions()[a] - cut_.positions()[b];
    double nearest = 1e-30;
    for (const Light& light : scene_.lights)
      if (light.type != LightType::directional) {
        const glm::dvec3 d = glm::dvec3(light.position) - cut_.positions()[a];
        nearest = std::max(nearest, glm::dot(dp, dp) / std::max(1e-300, glm::dot(d, d)));
      }
    return std::min(1e6, glm::dot(dn, dn) + nearest);
  }

  std::vector<std::uint32_t> apply(const std::vector<CutMark>& marks) {
    cut_.make_vertices(marks);
    colors_.add_new_vertices();
    FinishRange plain;
    // Of two diagonals the one that shows less; if that is little, the one that leaves no slivers.
    std::vector<std::uint32_t> changed =
        cut_.split([&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
          const double ac = error_between(a, c, plain).error, bd = error_between(b, d, plain).error;
          if (std::max(ac, bd) > 0.25 * options_.tolerance) return ac < bd;
          return std::min(sharpest_corner({a, b, c}), sharpest_corner({a, c, d})) >
                 std::min(sharpest_corner({a, b, d}), sharpest_corner({b, c, d}));
        });
    bounds_.resize(cut_.mesh().n_triangles(), infinity);
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
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  CutMesh cut_;
  CutColors colors_;
  Finishes finishes_;
  std::vector<double> bounds_;  ///< F'; infinite until known.
  std::size_t max_vertices_;
  double left_by_rounding_;  ///< What the output's rounding leaves of the tolerance.
  double shortest_side_;
  bool has_room_ = true;  ///< Whether max_vertices leaves any.
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
