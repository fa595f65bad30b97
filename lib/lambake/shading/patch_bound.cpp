#include "lambake/shading/patch_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lambake/shading/patch_bound.cpp"
#include <hwy/foreach_target.h>  // compiles the part below once per vector path
#include <hwy/highway.h>

#include "lambake/shading/enclosed_light-inl.h"
#include "lambake/shading/light_blocks.h"

#ifndef LAMBAKE_SHADING_PATCH_BOUND_ONCE
#define LAMBAKE_SHADING_PATCH_BOUND_ONCE
namespace lambake {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The steepest that the screen's curve is from `x` on, to within 8 %: a step function of its slope.
double steepest_from(double x) {
  constexpr int n_octaves = 9, n_steps = 8;  // from 2^-9, which is on the straight piece
  static const auto slopes = [] {
    std::array<double, n_octaves * n_steps> table{};
    for (int i = 0; i < n_octaves * n_steps; ++i) {
      const double at = std::ldexp(1 + double(i % n_steps) / n_steps, i / n_steps - n_octaves);
      table[static_cast<std::size_t>(i)] =
          at <= 0.0031308 ? 12.92 : 1.055 / 2.4 * std::pow(at, 1 / 2.4 - 1) * (1 + 1e-12);
    }
    return table;
  }();
  if (!(x > 0x1p-9)) return 12.92;
  if (x >= 1) return 0;
  int exponent = 0;
  const double mantissa = 2 * std::frexp(x, &exponent);  // in [1, 2)
  return slopes[static_cast<std::size_t>((exponent - 1 + n_octaves) * n_steps +
                                         static_cast<int>((mantissa - 1) * n_steps))];
}

/// A part of the patch and the bound over it.
struct Part {
  glm::dmat3 corners;
  double bound;
  int longest_side;          ///< Where the light varies most.
  std::uint32_t kink_light;  ///< The light whose terminator costs most, or none.
  bool operator<(const Part& other) const { return bound < other.bound; }
};

constexpr std::uint32_t no_light = ~0U;

/// Where the base colour spans texels, their range is taken in steps of this ratio.
constexpr double base_step = 1.25;

/// max S(F) − S(G) over G >= low_g, F <= high_f, F >= low_f, F − G <= e, S the curve of the screen. S is
/// concave from 0 on, so the smallest G is the worst; below 0 it is flat. At its joint it jumps by 3e-8.
double screen_gap(double low_f, double high_f, double low_g, double high_g, double e) {
  if (e <= 0) return 0;
  if (!(e < infinity)) return 1;  // Not a number, too.
  const double g = std::max(std::max(low_g, low_f - e), std::min(0.0, high_g));
  const double f = std::min(g + e, high_f);
  const auto screen = [](double x) { return srgb_encode(std::clamp(x, 0.0, 1.0)); };
  const double jump = g < 0.0031309 && f > 0.0031307 ? 4e-8 : 0;
  return std::min(1.0, std::max(0.0, screen(f) - screen(g)) + jump + 1e-15);
}

}  // namespace
}  // namespace lambake
#endif

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {
namespace {

/// What the lights give over a part of the patch.
struct LightSum {
  std::array<Enclosure, 3> channels{};  ///< In the order of Bounder's.
  bool is_bounded = true;
  double worst_kink = 0;
  std::uint32_t kink_light = no_light;
};

/// At least the longest normal.
inline double longest_of(const Enclosure& length_squared) {
  return std::sqrt(most(length_squared.linear[0], length_squared.linear[1], length_squared.linear[2])) *
         (1 + 1e-12);
}

/// Adds the first `n` functions, one after the other.
HWY_INLINE void add_lanes(const EnclosureOf<Lanes>& e, std::size_t n, Enclosure& sum) {
  HWY_ALIGN double values[8][n_lanes];
  const LaneTag d;
  for (std::size_t k = 0; k < 3; ++k) {
    hn::Store(e.linear[k].v, d, values[k]);
    hn::Store(e.quadratic[k].v, d, values[3 + k]);
  }
  hn::Store(e.low.v, d, values[6]), hn::Store(e.high.v, d, values[7]);
  for (std::size_t i = 0; i < std::min(n, n_lanes); ++i)
    sum = sum + Enclosure{{values[0][i], values[1][i], values[2][i]},
                          {values[3][i], values[4][i], values[5][i]},
                          values[6][i],
                          values[7][i]};
}

class Bounder {
 public:
  Bounder(const Patch& patch, const FinishRange& finish, std::span<const Light> all,
          std::span<const std::uint32_t> lights, const BoundOptions& options)
      : patch_(patch),
        finish_(finish),
        all_(all),
        lights_(lights),
        blocks_(light_blocks(all, lights)),
        options_(options) {
    const glm::dmat3& a = patch.albedos;
    has_albedo_ = a[0] != a[1] || a[1] != a[2];
    has_texels_ = finish.base_low != finish.base_high;
    for (int c = 0; c < 3; ++c) {
      bool is_new = true;
      for (int i = 0; i < n_channels_; ++i) is_new &= !is_same_channel(c, channels_[i]);
      if (is_new) channels_[n_channels_++] = c;
    }
  }

  PatchBound run() {
    const Part whole = make_part(glm::dmat3(1.0));
    result_.bound = whole.bound;
    if (result_.bound <= options_.accept) return result_;
    for (int c = 0; c < 3; ++c) look(whole.corners[c]);
    look(middle_of(whole.corners));
    std::priority_queue<Part> parts;
    parts.push(whole);
    std::vector<glm::dmat3> pieces;
    for (int n = 1; n < options_.max_parts && !is_good_enough(); n += static_cast<int>(pieces.size())) {
      const Part part = parts.top();
      parts.pop();
      pieces.clear();
      if (part.kink_light != no_light) cut_at_terminator(all_[part.kink_light], patch_, part.corners, pieces);
      if (pieces.size() < 2) bisect(part, pieces);
      // The first piece has all corners that are new.
      for (int c = 0; c < 3; ++c)
        if (pieces[0][c] != part.corners[0] && pieces[0][c] != part.corners[1] &&
            pieces[0][c] != part.corners[2])
          look(pieces[0][c]);
      for (const glm::dmat3& piece : pieces) {
        Part child = make_part(piece);
        // Over less of the surface the truth is not larger.
        child.bound = std::min(child.bound, part.bound);
        look(middle_of(piece));
        parts.push(child);
      }
      result_.bound = parts.top().bound;
    }
    return result_;
  }

  /// What the lights give over a part of the patch.
  LightSum light_over(const Patch& part) const {
    const Corners<double> normals = corners_of<double>(part.normals);
    const Enclosure length_squared = dot(normals, normals);
    const bool has_normal = is_positive(length_squared, range(length_squared));
    LightSum sum = sum_over(part, has_normal, has_normal ? longest_of(length_squared) : 1);
    if (has_normal && sum.is_bounded) {
      const Enclosure inverse_length = power(length_squared, -0.5);
      for (int k = 0; k < n_channels_; ++k) {
        Enclosure& e = sum.channels[static_cast<std::size_t>(k)];
        e = e * inverse_length;
      }
    }
    return sum;
  }

 private:
  /// Where the base colour spans texels, the bound holds for all of them, and comes no lower than what a
  /// sample shows with the worst.
  bool is_good_enough() const {
    return result_.bound <= options_.accept || least_bound_ > options_.reject ||
           result_.bound <= options_.tightness * least_bound_ + 1e-7;
  }

  /// Whether what is seen in channel a is what is seen in channel b, so that one of them is enough.
  bool is_same_channel(int a, int b) const {
    for (const std::uint32_t i : lights_) {
      const glm::vec3 intensity(all_[i].intensity.r, all_[i].intensity.g, all_[i].intensity.b);
      if (intensity[a] != intensity[b]) return false;
    }
    for (int k = 0; k < 3; ++k)
      if (patch_.albedos[k][a] != patch_.albedos[k][b] || patch_.colors[k][a] != patch_.colors[k][b])
        return false;
    return finish_.base_low[a] == finish_.base_low[b] && finish_.base_high[a] == finish_.base_high[b] &&
           finish_.emission_low[a] == finish_.emission_low[b] &&
           finish_.emission_high[a] == finish_.emission_high[b];
  }

  static void bisect(const Part& part, std::vector<glm::dmat3>& pieces) {
    pieces.clear();
    const int i = part.longest_side, j = (i + 1) % 3, k = (i + 2) % 3;
    const glm::dvec3 middle = 0.5 * (part.corners[i] + part.corners[j]);
    pieces.emplace_back(part.corners[i], middle, part.corners[k]);
    pieces.emplace_back(middle, part.corners[j], part.corners[k]);
  }

  static glm::dvec3 middle_of(const glm::dmat3& corners) {
    return (corners[0] + corners[1] + corners[2]) / 3.0;
  }

  /// Samples the error at the barycentrics `b`.
  void look(const glm::dvec3& b) {
    const glm::dvec3 f = reference_at(patch_, all_, lights_, finish_.is_unlit, b);
    const glm::dvec3 g = patch_.colors * b;
    for (int i = 0; i < n_channels_; ++i) {
      // Found is found with any finish within its range.
      const int c = channels_[i];
      const double e = error_at(f[c], g[c], finish_.base_low[c], finish_.emission_low[c], result_.found);
      if (e > result_.found) result_.found = e, result_.found_at = b;
      least_bound_ = std::max(least_bound_, result_.found);
      if (!has_texels_) continue;
      // The worst is the brightest, but on a screen no brighter than it goes.
      const double emission = finish_.emission_low[c], most = finish_.base_high[c];
      const double base =
          options_.space == ErrorSpace::linear
              ? most
              : std::clamp((1 - emission) / std::max({f[c], g[c], 1e-300}), finish_.base_low[c], most);
      least_bound_ = std::max(least_bound_, error_at(f[c], g[c], base, emission, least_bound_));
    }
  }

  /// |F − G| with a finish; anything from 0 to `known` if it is no larger than that.
  double error_at(double f, double g, double base, double emission, double known) const {
    const double e = base * std::abs(f - g);
    if (options_.space == ErrorSpace::linear) return e;
    if (steepest_from(emission + base * std::min(f, g)) * e <= known) return 0;
    return std::abs(compared(emission + base * f, options_.space) -
                    compared(emission + base * g, options_.space));
  }

  /// The sum of the lights over a part of the patch: ‖N‖ times what it receives, with `has_normal`.
  LightSum sum_over(const Patch& patch, bool has_normal, double longest) const {
    const Corners<Lanes> n = corners_of<Lanes>(patch.normals), p = corners_of<Lanes>(patch.positions);
    constexpr std::size_t size = LightBlock::size;
    std::array<EnclosureOf<Lanes>, 3> sums[size / n_lanes] = {};
    HWY_ALIGN double kinks[size];
    LightSum result;
    std::size_t n_most = 0;
    for (const LightBlock& block : blocks_) {
      n_most = std::max(n_most, block.n);
      for (std::size_t i = 0; i < size / n_lanes; ++i) {
        const std::size_t first = i * n_lanes;
        const EnclosureOf<Lanes> r =
            received_over(block.kind, load_lights(block, first), n, p, has_normal, longest);
        result.is_bounded = result.is_bounded && all(r.high < Lanes(infinity));
        for (int k = 0; k < n_channels_; ++k) {
          EnclosureOf<Lanes>& sum = sums[i][static_cast<std::size_t>(k)];
          sum = sum + scaled(load(block.intensity[channels_[k]] + first), r);
        }
        hn::Store((-r.low * load(block.brightest + first)).v, LaneTag(), kinks + first);
      }
      if (!result.is_bounded) return result;
      for (std::size_t i = 0; i < block.n; ++i)
        if (kinks[i] > result.worst_kink && is_crossed(all_[block.lights[i]], patch))
          result.worst_kink = kinks[i], result.kink_light = block.lights[i];
    }
    // Behind the fullest block there is no light.
    for (int k = 0; k < n_channels_; ++k)
      for (std::size_t i = 0; i < size / n_lanes && i * n_lanes < n_most; ++i)
        add_lanes(sums[i][static_cast<std::size_t>(k)], n_most - i * n_lanes,
                  result.channels[static_cast<std::size_t>(k)]);
    return result;
  }

  Part make_part(const glm::dmat3& corners) const {
    const Patch patch = part_of(patch_, corners);
    Part part{corners, 0, 0, no_light};
    std::array<Enclosure, 3> light{};
    if (finish_.is_unlit) {
      light.fill(linear(1.0, 1.0, 1.0));
    } else {
      const LightSum sum = light_over(patch);
      if (!sum.is_bounded) {
        part.bound = infinity;
        part.longest_side = longest_side(patch);
        return part;
      }
      for (int k = 0; k < n_channels_; ++k)
        light[static_cast<std::size_t>(channels_[k])] = sum.channels[static_cast<std::size_t>(k)];
      part.kink_light = sum.kink_light;
      double widest = 0;
      for (const Enclosure& e : light) widest = std::max(widest, e.high - e.low);
      if (sum.worst_kink < 0.3 * widest) part.kink_light = no_light;
    }
    std::array<double, 3> variation{};
    double widest_rest = 0;
    for (int i = 0; i < n_channels_; ++i) {
      const int c = channels_[i];
      const glm::dmat3& a = patch.albedos;
      Enclosure f = light[static_cast<std::size_t>(c)];
      if (has_albedo_) {
        f = linear(a[0][c], a[1][c], a[2][c]) * f;
      } else {
        f = scaled(a[0][c], f);
      }
      Enclosure e = f;
      for (std::size_t k = 0; k < 3; ++k) e.linear[k] -= patch.colors[static_cast<int>(k)][c];
      widen(e, magnitude(f));
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        variation[k] =
            std::max(variation[k], std::abs(f.linear[k] - f.linear[next]) + 4 * std::abs(f.quadratic[k]));
      }
      widest_rest = std::max(widest_rest, f.high - f.low);
      const double bound = bound_of(c, range(f), range(e), patch);
      part.bound = std::isnan(bound) ? infinity : std::max(part.bound, bound);
    }
    // Where light hardly varies, what the normals and distances do apart is what keeps the interval wide.
    if (widest_rest > *std::max_element(variation.begin(), variation.end())) variation = spreads(patch);
    part.longest_side =
        static_cast<int>(std::max_element(variation.begin(), variation.end()) - variation.begin());
    if (!(variation[static_cast<std::size_t>(part.longest_side)] > 0))
      part.longest_side = longest_side(patch);
    return part;
  }

  /// The bound in channel c. One base colour holds for F and G: where it spans a texture's texels and that
  /// matters, it is taken in steps.
  double bound_of(int c, Interval f, Interval e, const Patch& patch) const {
    constexpr double step = base_step, darkest = 1.0 / 256;
    const double least = finish_.base_low[c], most = finish_.base_high[c];
    double bound = bound_of(c, f, e, patch, least, most);
    if (bound <= options_.accept || !(most > step * least) || options_.space == ErrorSpace::linear)
      return bound;
    bound = 0;
    for (double high = most; high > least;) {
      const double low = high > darkest * most ? std::max(least, high / step) : least;
      bound = std::max(bound, bound_of(c, f, e, patch, low, high));
      high = low;
    }
    return bound;
  }

  /// The same for base colours from b0 to b1.
  double bound_of(int c, Interval f, Interval e, const Patch& patch, double b0, double b1) const {
    const double low_e = std::min(b0 * e.low, b1 * e.low), high_e = std::max(b0 * e.high, b1 * e.high);
    if (options_.space == ErrorSpace::linear) return std::max({-low_e, high_e, 0.0}) * (1 + 1e-15);
    const double g0 = std::min({patch.colors[0][c], patch.colors[1][c], patch.colors[2][c]});
    const double g1 = std::max({patch.colors[0][c], patch.colors[1][c], patch.colors[2][c]});
    f.low = std::max(0.0, f.low);
    const double low = finish_.emission_low[c], high = finish_.emission_high[c];
    const double low_f = low + b0 * f.low, high_f = high + b1 * f.high;
    const double low_g = low + std::min(b0 * g0, b1 * g0), high_g = high + std::max(b0 * g1, b1 * g1);
    // Most triangles are far below what is accepted: no power is needed to see that.
    const double rise = std::max(high_e, 0.0), fall = std::max(-low_e, 0.0);
    const double at_most = 4e-8 + std::max(steepest_from(std::max(low_g, low_f - rise)) * rise,
                                           steepest_from(std::max(low_f, low_g - fall)) * fall);
    if (at_most <= options_.accept) return at_most;
    return std::max(screen_gap(low_f, high_f, low_g, high_g, high_e),
                    screen_gap(low_g, high_g, low_f, high_f, -low_e));
  }

  static bool is_crossed(const Light& light, const Patch& patch) {
    bool has_lit = false, has_dark = false;
    for (int c = 0; c < 3; ++c) {
      const double s = facing(light, patch.positions[c], patch.normals[c]);
      has_lit |= s > 0, has_dark |= s < 0;
    }
    return has_lit && has_dark;
  }

  /// How far the normals at the ends of each side are apart, and the positions as nearby lamps see them;
  /// squared, without unit.
  std::array<double, 3> spreads(const Patch& patch) const {
    std::array<double, 3> spread{};
    double nearest = infinity;
    for (const std::uint32_t i : lights_)
      if (all_[i].type != LightType::directional)
        for (int k = 0; k < 3; ++k) {
          const glm::dvec3 d = glm::dvec3(all_[i].position) - patch.positions[k];
          nearest = std::min(nearest, glm::dot(d, d));
        }
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const glm::dvec3 dn = patch.normals[next] - patch.normals[k];
      const glm::dvec3 dp = patch.positions[next] - patch.positions[k];
      spread[static_cast<std::size_t>(k)] = glm::dot(dn, dn) + glm::dot(dp, dp) / std::max(nearest, 1e-300);
    }
    return spread;
  }

  static int longest_side(const Patch& patch) {
    int longest = 0;
    double length = -1;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 d = patch.positions[(k + 1) % 3] - patch.positions[k];
      if (glm::dot(d, d) > length) length = glm::dot(d, d), longest = k;
    }
    return longest;
  }

  const Patch& patch_;
  const FinishRange& finish_;
  std::span<const Light> all_;
  std::span<const std::uint32_t> lights_;
  std::vector<LightBlock> blocks_;
  const BoundOptions& options_;
  bool has_albedo_ = false, has_texels_ = false;
  double least_bound_ = 0;                 ///< See is_good_enough().
  int channels_[3] = {}, n_channels_ = 0;  ///< Those that differ from each other.
  PatchBound result_;
};

Enclosure light_over_of(const Light& light, const Patch& patch) {
  Light white = light;
  white.intensity = {1, 1, 1};
  const std::uint32_t index = 0;
  const LightSum sum = Bounder(patch, {}, {&white, 1}, {&index, 1}, {}).light_over(patch);
  return sum.is_bounded ? sum.channels[0] : anything_in<double>({0, infinity});
}

PatchBound bound_of(const Patch& patch, const FinishRange& finish, std::span<const Light> all,
                    std::span<const std::uint32_t> lights, const BoundOptions& options) {
  return Bounder(patch, finish, all, lights, options).run();
}

}  // namespace
}  // namespace lambake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lambake {
namespace {
HWY_EXPORT(bound_of);
HWY_EXPORT(light_over_of);
}  // namespace

PatchBound bound_patch(const Patch& patch, const FinishRange& finish, std::span<const Light> all,
                       std::span<const std::uint32_t> lights, const BoundOptions& options) {
  return HWY_DYNAMIC_DISPATCH(bound_of)(patch, finish, all, lights, options);
}

Enclosure light_over(const Light& light, const Patch& patch) {
  return HWY_DYNAMIC_DISPATCH(light_over_of)(light, patch);
}

}  // namespace lambake
#endif  // HWY_ONCE
