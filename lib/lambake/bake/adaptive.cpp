#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <tuple>
#include <vector>

#include "lambake/bake/methods.h"
#include "lambake/core/bounds.h"
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

/// A cut this near to an end leaves a sliver and no gain.
constexpr double nearest_cut = 1e-4;

/// Sides shorter than this share of the mesh's size are not cut: positions in float would hardly carry it.
constexpr double shortest_share = 1e-5;

/// A place on a side of a triangle where the error is large.
struct SideError {
  double error = 0;
  double t = 0.5;  ///< From the vertex at the lower place to the one at the higher.
};

class AdaptiveBake {
 public:
  AdaptiveBake(const Scene& scene, const BakeOptions& options)
      : scene_(scene), options_(options), cut_(scene.mesh), finishes_(scene) {
    all_lights_.resize(scene.lights.size());
    for (std::uint32_t i = 0; i < all_lights_.size(); ++i) all_lights_[i] = i;
    is_unlit_.resize(scene.mesh.n_vertices(), false);
    for (std::size_t f = 0; f < scene.mesh.n_triangles(); ++f)
      if (scene.materials[scene.mesh.material_of(f)].is_unlit)
        for (int c = 0; c < 3; ++c) is_unlit_[scene.mesh.triangles[f][c]] = true;
    color_new_vertices();
    bounds_.resize(scene.mesh.n_triangles());
    shortest_side_ = shortest_share * bounds_of(scene.mesh.positions).radius();
  }

  BakedColors run() {
    const auto start = std::chrono::steady_clock::now();
    BakedColors baked;
    Certificate& certificate = baked.certificate.emplace();
    certificate.smallest_angle_before = smallest_angle();

    std::vector<std::uint32_t> active(cut_.mesh().n_triangles());
    for (std::uint32_t f = 0; f < active.size(); ++f) active[f] = f;
    bool has_room = true;
    for (int round = 0; round < max_rounds && has_room; ++round) {
      bound(active);
      std::vector<CutMark> marks = find_marks(active, has_room);
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
      if (marks.empty() || (options_.max_seconds > 0 && elapsed.count() > options_.max_seconds)) break;
      report_progress(options_.progress, "cutting", static_cast<double>(round) / max_rounds);
      active = apply(marks);
    }
    bound(active);
    const std::size_t n_spoilt = take_stored_colors();

    certificate.smallest_angle_after = smallest_angle();
    std::size_t unbounded = 0;
    for (const double b : bounds_) {
      certificate.max_bound = std::max(certificate.max_bound, b);
      certificate.open_triangles += b > options_.tolerance;
      unbounded += !std::isfinite(b);
    }
    certificate.is_certified = certificate.open_triangles == 0;
    add_finding(baked.findings, "unbounded_triangles", unbounded,
                "triangles are touched by a light, so that their error has no bound");
    add_finding(baked.findings, "open_triangles", certificate.open_triangles - unbounded,
                "triangles are not certified to be within the tolerance");
    add_finding(
        baked.findings, "triangles_open_by_storage", n_spoilt,
        "of them would be, but for what the output clips or rounds: a lower exposure or finer colours "
        "help there, cutting does not");
    baked.colors = std::move(colors_);
    baked.cuts = cut_.cuts();
    baked.parent_triangles = cut_.parent_triangles();
    baked.mesh = cut_.take_mesh();
    return baked;
  }

 private:
  glm::dvec3 albedo(std::uint32_t v) const {
    return cut_.albedos().empty() ? glm::dvec3(1) : cut_.albedos()[v];
  }

  /// The colours of the vertices that have none yet: the reference at the vertex, as the output stores it
  /// unless that spoils it.
  void color_new_vertices() {
    const std::size_t first = colors_.size(), n = cut_.mesh().n_vertices();
    for (std::size_t i = is_unlit_.size(); i < n; ++i) {
      const EdgeCut& cut = cut_.cuts()[i - cut_.n_uncut_vertices()];
      is_unlit_.push_back(is_unlit_[cut.a] && is_unlit_[cut.b]);
    }
    colors_.resize(n);
    if (options_.as_stored) stored_.resize(n), is_spoilt_.resize(n, false);
    parallel_blocks(n - first, block_size, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = first + begin; i < first + end; ++i) {
        Patch point;
        point.positions[0] = cut_.positions()[i];
        point.normals[0] = cut_.normals()[i];
        point.albedos[0] = albedo(static_cast<std::uint32_t>(i));
        const glm::dvec3 c =
            reference_at(point, scene_.lights, all_lights_, is_unlit_[i], glm::dvec3(1, 0, 0));
        colors_[i] = {static_cast<float>(c.r), static_cast<float>(c.g), static_cast<float>(c.b)};
        if (!options_.as_stored) continue;
        stored_[i] = options_.as_stored(colors_[i]);
        is_spoilt_[i] = is_spoilt(colors_[i], stored_[i]);
        if (!is_spoilt_[i]) colors_[i] = stored_[i];
      }
    });
  }

  /// Whether so much of a colour is lost in the output that no cut around the vertex can mend it.
  bool is_spoilt(const LinearRgb& color, const LinearRgb& stored) const {
    const auto loss = [&](float was, float is) {
      return options_.tolerance_space == ErrorSpace::linear
                 ? std::abs(double(was) - double(is))
                 : std::abs(srgb_encode(double(was)) - srgb_encode(double(is)));
    };
    return std::max({loss(color.r, stored.r), loss(color.g, stored.g), loss(color.b, stored.b)}) >
           0.25 * options_.tolerance;
  }

  /// Cuts are chosen for the colours as they should be where the output spoils them; what is certified is
  /// what is stored. @returns how many triangles come to be above the tolerance by that.
  std::size_t take_stored_colors() {
    if (!options_.as_stored) return 0;
    std::vector<std::uint32_t> spoilt;
    for (std::uint32_t f = 0; f < cut_.mesh().n_triangles(); ++f) {
      const glm::uvec3& t = cut_.mesh().triangles[f];
      if (is_spoilt_[t[0]] || is_spoilt_[t[1]] || is_spoilt_[t[2]]) spoilt.push_back(f);
    }
    const auto count_open = [&] {
      return static_cast<std::size_t>(std::count_if(
          spoilt.begin(), spoilt.end(), [&](std::uint32_t f) { return bounds_[f] > options_.tolerance; }));
    };
    const std::size_t n_before = count_open();
    colors_ = stored_;
    bound(spoilt);
    return count_open() - n_before;
  }

  Patch patch_of(const glm::uvec3& t) const {
    Patch patch;
    for (int c = 0; c < 3; ++c) {
      patch.positions[c] = cut_.positions()[t[c]];
      patch.normals[c] = cut_.normals()[t[c]];
      patch.albedos[c] = albedo(t[c]);
      patch.colors[c] = {colors_[t[c]].r, colors_[t[c]].g, colors_[t[c]].b};
    }
    return patch;
  }

  static bool has_area(const Patch& patch) {
    const double area = glm::length(
        glm::cross(patch.positions[1] - patch.positions[0], patch.positions[2] - patch.positions[0]));
    return area > 0 && std::isfinite(area);
  }

  std::vector<std::uint32_t> lights_reaching(const Patch& patch) const {
    std::vector<std::uint32_t> lights;
    for (const std::uint32_t i : all_lights_)
      if (!is_unreached(scene_.lights[i], patch)) lights.push_back(i);
    return lights;
  }

  /// Certified bounds of the triangles; no better than the tolerance needs.
  void bound(const std::vector<std::uint32_t>& triangles) {
    BoundOptions how;
    how.space = options_.tolerance_space;
    how.accept = how.reject = options_.tolerance;
    how.max_parts = 100;  // cutting is the better way to go on
    parallel_blocks(triangles.size(), block_size, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t f = triangles[i];
        const Patch patch = patch_of(cut_.mesh().triangles[f]);
        bounds_[f] = 0;
        if (!has_area(patch)) continue;
        bounds_[f] =
            bound_patch(patch, finishes_.over(cut_.mesh(), f), scene_.lights, lights_reaching(patch), how)
                .bound;
      }
    });
  }

  /// The largest error on the side between the vertices a and b, at the brightest finish: at the terminators
  /// that cross it, where the error has its peaks, and between.
  SideError side_error(std::uint32_t a, std::uint32_t b, const FinishRange& finish) const {
    if (cut_.places()[a] > cut_.places()[b]) std::swap(a, b);
    const Patch patch = patch_of({a, b, b});
    const std::vector<std::uint32_t> lights = lights_reaching(patch);
    const auto error_at = [&](double t) {
      const glm::dvec3 at(1 - t, t, 0);
      const glm::dvec3 f = reference_at(patch, scene_.lights, lights, finish.is_unlit, at);
      const glm::dvec3 g = patch.colors * at;
      double error = 0;
      for (int c = 0; c < 3; ++c) {
        const double base = finish.base_high[c], emission = finish.emission_low[c];
        error = std::max(error, options_.tolerance_space == ErrorSpace::linear
                                    ? base * std::abs(f[c] - g[c])
                                    : std::abs(srgb_encode(std::clamp(emission + base * f[c], 0.0, 1.0)) -
                                               srgb_encode(std::clamp(emission + base * g[c], 0.0, 1.0))));
      }
      return error;
    };
    // Denser near the ends: on screen the peak lies close to a dark one.
    std::vector<double> samples{0,     1 / 256.0, 1 / 64.0, 1 / 16.0,  0.125,     0.25,        0.375, 0.5,
                                0.625, 0.75,      0.875,    15 / 16.0, 63 / 64.0, 255 / 256.0, 1};
    for (const std::uint32_t i : lights) {
      const Light& light = scene_.lights[i];
      const double s0 = facing(light, patch.positions[0], patch.normals[0]);
      const double s1 = facing(light, patch.positions[1], patch.normals[1]);
      if (s0 * s1 < 0) samples.push_back(terminator_on_edge(light, patch, 0, 1));
    }
    std::sort(samples.begin(), samples.end());
    SideError worst;
    std::size_t nearest = 1;
    for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
      const double error = error_at(samples[i]);
      if (error > worst.error) worst = {error, samples[i]}, nearest = i;
    }
    // Climbs from the best sample.
    double low = samples[nearest - 1], high = samples[nearest + 1];
    for (int i = 0; i < 6 && worst.error > 0; ++i) {
      for (const double t : {0.5 * (low + worst.t), 0.5 * (worst.t + high)}) {
        const double error = error_at(t);
        if (error > worst.error) {
          (t > worst.t ? low : high) = worst.t;
          worst = {error, t};
          break;
        }
        (t < worst.t ? low : high) = t;
      }
    }
    return worst;
  }

  /// Where to cut for the triangles of `active` that are above the tolerance: every side with an error above
  /// it, which no other cut can mend, or else the worst side.
  std::vector<CutMark> find_marks(const std::vector<std::uint32_t>& active, bool& has_room) const {
    std::vector<std::uint32_t> open;
    for (const std::uint32_t f : active)
      if (bounds_[f] > options_.tolerance) open.push_back(f);
    struct Candidate {
      std::uint32_t low, high;
      double error, t;
    };
    std::vector<std::array<Candidate, 3>> found(open.size());
    parallel_blocks(open.size(), block_size, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const FinishRange finish = finishes_.over(cut_.mesh(), open[i]);
        const glm::uvec3& t = cut_.mesh().triangles[open[i]];
        std::array<double, 3> merit{};
        glm::dvec3 lengths;
        for (int k = 0; k < 3; ++k)
          lengths[k] = glm::length(cut_.positions()[t[(k + 1) % 3]] - cut_.positions()[t[k]]);
        const double longest = std::max({lengths[0], lengths[1], lengths[2]});
        for (int k = 0; k < 3; ++k) {
          const std::uint32_t a = t[k], b = t[(k + 1) % 3];
          const SideError side = side_error(a, b, finish);
          const auto [low, high] = std::minmax(cut_.places()[a], cut_.places()[b]);
          found[i][static_cast<std::size_t>(k)] = {low, high, side.error, side.t};
          // Where no side is above the tolerance: the worst, but no short side of a sliver; where none shows
          // an error at all, the one along which the normal and the position turn most.
          merit[static_cast<std::size_t>(k)] =
              (side.error + 1e-3 * options_.tolerance * bend(a, b)) * (0.1 + lengths[k] / longest);
        }
        const auto worst =
            static_cast<std::size_t>(std::max_element(merit.begin(), merit.end()) - merit.begin());
        for (std::size_t k = 0; k < 3; ++k) {
          Candidate& c = found[i][k];
          const bool is_needed = c.error > options_.tolerance || k == worst;
          const bool is_too_short = !(lengths[static_cast<int>(k)] > shortest_side_);
          if (!is_needed || c.low == c.high || is_too_short) c.error = -1;
          if (c.error >= 0 && c.error < 0.05 * options_.tolerance) c.t = 0.5;
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
    if (options_.max_vertices > 0) {
      const std::size_t n = cut_.mesh().n_vertices();
      const std::size_t room = options_.max_vertices > n ? options_.max_vertices - n : 0;
      if (candidates.size() > room) {
        has_room = false;
        std::stable_sort(candidates.begin(), candidates.end(),
                         [](const Candidate& x, const Candidate& y) { return x.error > y.error; });
        candidates.resize(room);
      }
    }
    std::vector<CutMark> marks;
    marks.reserve(candidates.size());
    for (const Candidate& c : candidates)
      marks.push_back({c.low, c.high, static_cast<float>(std::clamp(c.t, nearest_cut, 1 - nearest_cut))});
    return marks;
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
    color_new_vertices();
    FinishRange plain;
    std::vector<std::uint32_t> changed = cut_.split([&](std::uint32_t a, std::uint32_t b) {
      const glm::dvec3 d = cut_.positions()[a] - cut_.positions()[b];
      return side_error(a, b, plain).error + 1e-6 * glm::length(d);
    });
    bounds_.resize(cut_.mesh().n_triangles());
    return changed;
  }

  double smallest_angle() const {
    double smallest = 3.141592653589793 / 3;
    for (const glm::uvec3& t : cut_.mesh().triangles)
      for (int c = 0; c < 3; ++c) {
        const glm::dvec3 p = cut_.positions()[t[c]], a = cut_.positions()[t[(c + 1) % 3]] - p,
                         b = cut_.positions()[t[(c + 2) % 3]] - p;
        const double sine = glm::length(glm::cross(a, b));
        if (sine > 0 && std::isfinite(sine)) smallest = std::min(smallest, std::atan2(sine, glm::dot(a, b)));
      }
    return smallest;
  }

  const Scene& scene_;
  const BakeOptions& options_;
  CutMesh cut_;
  Finishes finishes_;
  std::vector<std::uint32_t> all_lights_;
  std::vector<char> is_unlit_;     ///< V'
  std::vector<LinearRgb> colors_;  ///< V'
  std::vector<LinearRgb> stored_;  ///< V', if the output stores colours otherwise.
  std::vector<char> is_spoilt_;    ///< V', with `stored_`.
  double shortest_side_ = 0;
  std::vector<double> bounds_;  ///< F'
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
