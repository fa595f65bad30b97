#include "lambake/shading/light_field.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lambake/shading/light_field.cpp"
#include <hwy/foreach_target.h>  // compiles the part below once per vector path
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using V = hn::Vec<Floats>;

constexpr std::size_t lanes = hn::MaxLanes(Floats());
constexpr int order = LightField::order;
constexpr int n_coefficients = LightField::n_coefficients;

constexpr int at(int l, int m) {
  return LightField::harmonic_index(l, m);
}

V set(float v) {
  return hn::Set(Floats(), v);
}

/// Sixteen numbers on every path, so that sums over lanes have the same order on all of them.
struct Sixteen {
  static constexpr std::size_t n_parts = 16 / lanes;
  V part[n_parts];
};

/// Irregular solid harmonics (l − m)! P_l^m(cos θ) e^{imφ} / r^(l+1) of (x, y, z).
HWY_INLINE void irregular_harmonics(V x, V y, V z, V s[n_coefficients]) {
  const V one = set(1.0f);
  const V r2 = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
  const V inverse = hn::Div(one, r2);
  x = hn::Mul(x, inverse), y = hn::Mul(y, inverse), z = hn::Mul(z, inverse);
  s[0] = hn::Sqrt(inverse);
#pragma GCC unroll 16
  for (int m = 0; m <= order; ++m) {
    if (m == 1) {
      s[at(1, 1)] = hn::Mul(x, s[0]);
      s[at(1, 1) + 1] = hn::Mul(y, s[0]);
    } else if (m > 1) {
      const V re = s[at(m - 1, m - 1)], im = s[at(m - 1, m - 1) + 1], factor = set(float(2 * m - 1));
      s[at(m, m)] = hn::Mul(factor, hn::Sub(hn::Mul(x, re), hn::Mul(y, im)));
      s[at(m, m) + 1] = hn::Mul(factor, hn::Add(hn::Mul(x, im), hn::Mul(y, re)));
    }
#pragma GCC unroll 16
    for (int l = m + 1; l <= order; ++l)
#pragma GCC unroll 2
      for (int part = 0; part <= (m > 0); ++part) {
        V next = hn::Mul(hn::Mul(set(float(2 * l - 1)), z), s[at(l - 1, m) + part]);
        if (l > m + 1)
          next = hn::Sub(
              next, hn::Mul(hn::Mul(set(float((l - 1) * (l - 1) - m * m)), inverse), s[at(l - 2, m) + part]));
        s[at(l, m) + part] = next;
      }
  }
}

/// Regular solid harmonics r^l P_l^m(cos θ) e^{imφ} / (l + m)! of (x, y, z), up to order − 1.
HWY_INLINE void regular_harmonics(V x, V y, V z, V s[n_coefficients]) {
  const V r2 = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
  s[0] = set(1.0f);
#pragma GCC unroll 16
  for (int m = 0; m < order; ++m) {
    if (m == 1) {
      s[at(1, 1)] = hn::Mul(set(0.5f), x);
      s[at(1, 1) + 1] = hn::Mul(set(0.5f), y);
    } else if (m > 1) {
      const V re = s[at(m - 1, m - 1)], im = s[at(m - 1, m - 1) + 1], factor = set(0.5f / float(m));
      s[at(m, m)] = hn::Mul(factor, hn::Sub(hn::Mul(x, re), hn::Mul(y, im)));
      s[at(m, m) + 1] = hn::Mul(factor, hn::Add(hn::Mul(x, im), hn::Mul(y, re)));
    }
#pragma GCC unroll 16
    for (int l = m + 1; l < order; ++l)
#pragma GCC unroll 2
      for (int part = 0; part <= (m > 0); ++part) {
        const float divisor = float((l + m) * (l - m));
        V next = hn::Mul(hn::Mul(set(float(2 * l - 1) / divisor), z), s[at(l - 1, m) + part]);
        if (l > m + 1)
          next = hn::Sub(next, hn::Mul(hn::Mul(set(1.0f / divisor), r2), s[at(l - 2, m) + part]));
        s[at(l, m) + part] = next;
      }
  }
}

float sum_of_lanes(const Sixteen& s) {
  HWY_ALIGN float values[16];
  for (std::size_t i = 0; i < Sixteen::n_parts; ++i) hn::Store(s.part[i], Floats(), values + i * lanes);
  for (int half = 8; half > 0; half /= 2)
    for (int i = 0; i < half; ++i) values[i] += values[i + half];
  return values[0];
}

using Sums = Sixteen[3][n_coefficients];

/// Adds `n_groups` times sixteen lights: their harmonics first, so that each sum is loaded and stored once
/// for all.
template <int n_groups>
HWY_INLINE void add_groups(const LightField& field, const LightArrays& lights, std::size_t begin,
                           Sums& sums) {
  const V scale = set(1.0f / field.radius);
  const V cx = set(field.center.x), cy = set(field.center.y), cz = set(field.center.z);
  for (std::size_t p = 0; p < Sixteen::n_parts; ++p) {
    V s[n_groups][n_coefficients], intensity[3][n_groups];
    for (int i = 0; i < n_groups; ++i) {
      const std::size_t at_light = begin + 16 * static_cast<std::size_t>(i) + p * lanes;
      const auto load = [&](const std::vector<float>& from)
                            HWY_ATTR { return hn::LoadU(Floats(), &from[at_light]); };
      irregular_harmonics(hn::Mul(hn::Sub(load(lights.x), cx), scale),
                          hn::Mul(hn::Sub(load(lights.y), cy), scale),
                          hn::Mul(hn::Sub(load(lights.z), cz), scale), s[i]);
      intensity[0][i] = load(lights.r), intensity[1][i] = load(lights.g), intensity[2][i] = load(lights.b);
    }
    for (int c = 0; c < 3; ++c)
      for (int k = 1; k < n_coefficients; ++k) {
        V sum = sums[c][k].part[p];
        for (int i = 0; i < n_groups; ++i) sum = hn::Add(sum, hn::Mul(intensity[c][i], s[i][k]));
        sums[c][k].part[p] = sum;
      }
  }
}

void add_lights_to(LightField& field, const LightArrays& lights, std::size_t begin, std::size_t end) {
  Sums sums;
  for (auto& channel : sums)
    for (Sixteen& sum : channel)
      for (V& part : sum.part) part = hn::Zero(Floats());
  std::size_t i = begin;
  for (; i + 64 <= end; i += 64) add_groups<4>(field, lights, i, sums);
  for (; i < end; i += 16) add_groups<1>(field, lights, i, sums);
  for (int c = 0; c < 3; ++c)
    for (int k = 1; k < n_coefficients; ++k) field.coefficients[c][k] += sum_of_lanes(sums[c][k]);
}

/// Complex coefficients for all m in [−l, l], at l·l + l + m: a lane for each of four fields and four
/// channels, one of them unused.
template <int n>
struct ComplexLanes {
  HWY_ALIGN float re[n][16];
  HWY_ALIGN float im[n][16];

  /// Some lanes of those of ±m; those of −m are (−1)^m times the conjugates.
  HWY_INLINE void set(int l, int m, std::size_t lane, V real, V imaginary) {
    const Floats f;
    const bool is_odd = m % 2 != 0;
    const int at_m = l * l + l + m, at_minus_m = l * l + l - m;
    hn::Store(is_odd ? hn::Neg(real) : real, f, re[at_minus_m] + lane);
    hn::Store(is_odd ? imaginary : hn::Neg(imaginary), f, im[at_minus_m] + lane);
    hn::Store(real, f, re[at_m] + lane);
    hn::Store(imaginary, f, im[at_m] + lane);
  }
};

/// With the solid harmonics of above, R_l^m(d + t) = Σ_{j,k} R_j^k(t) R_{l−j}^{m−k}(d), hence the coefficient
/// (j, k) of what is a sum over conj(L) R becomes Σ_{l,m} L_l^m conj(R_{l−j}^{m−k}(d)).
void translate_to_four(const LightField& from, std::span<LightField> to) {
  const float scale = 1.0f / from.radius;
  HWY_ALIGN float centers[3][16] = {}, harmonics[order * order][16];
  for (std::size_t i = 0; i < to.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) centers[axis][i] = (to[i].center[axis] - from.center[axis]) * scale;
  const Floats f;
  for (std::size_t lane = 0; lane < 4; lane += lanes) {
    V s[n_coefficients];
    regular_harmonics(hn::Load(f, centers[0] + lane), hn::Load(f, centers[1] + lane),
                      hn::Load(f, centers[2] + lane), s);
    for (int k = 0; k < order * order; ++k) hn::Store(s[k], f, harmonics[k] + lane);
  }
  const auto by_channel = [&](int k, float* row) HWY_ATTR {
    for (int field = 0; field < 4; ++field)
      for (std::size_t c = 0; c < 4; ++c)
        row[4 * static_cast<std::size_t>(field) + c] =
            static_cast<float>(from.coefficients[std::min<std::size_t>(c, 2)][static_cast<std::size_t>(k)]);
  };
  const auto by_field = [&](int k, float* row) HWY_ATTR {
    for (int lane = 0; lane < 16; ++lane) row[lane] = harmonics[k][lane / 4];
  };
  const auto spread = [&](const auto& fill, int highest, auto& all) HWY_ATTR {
    HWY_ALIGN float re[16], im[16] = {};
    for (int l = 0; l <= highest; ++l)
      for (int m = 0; m <= l; ++m) {
        fill(at(l, m), re);
        if (m > 0) fill(at(l, m) + 1, im);
        for (std::size_t lane = 0; lane < 16; lane += lanes) {
          const V imaginary = m > 0 ? hn::Load(f, im + lane) : hn::Zero(f);
          all.set(l, m, lane, hn::Load(f, re + lane), imaginary);
        }
      }
  };
  ComplexLanes<order * order> shift;
  ComplexLanes<n_coefficients> source;
  spread(by_field, order - 1, shift);
  spread(by_channel, order, source);
  for (int j = 1; j <= order; ++j)
    for (int k = 0; k <= j; ++k) {
      HWY_ALIGN float re[16], im[16];
      for (std::size_t lane = 0; lane < 16; lane += lanes) {
        V sum_re = hn::Zero(f), sum_im = hn::Zero(f);
        for (int l = j; l <= order; ++l) {
          const int n = l - j;
          for (int m = std::max(-l, k - n); m <= std::min(l, k + n); ++m) {
            const int a = l * l + l + m, b = n * n + n + m - k;
            const V a_re = hn::Load(f, source.re[a] + lane), a_im = hn::Load(f, source.im[a] + lane);
            const V b_re = hn::Load(f, shift.re[b] + lane), b_im = hn::Load(f, shift.im[b] + lane);
            sum_re = hn::Add(sum_re, hn::Add(hn::Mul(a_re, b_re), hn::Mul(a_im, b_im)));
            sum_im = hn::Add(sum_im, hn::Sub(hn::Mul(a_im, b_re), hn::Mul(a_re, b_im)));
          }
        }
        hn::Store(sum_re, f, re + lane);
        hn::Store(sum_im, f, im + lane);
      }
      for (std::size_t i = 0; i < to.size(); ++i) {
        // The harmonics of degree j and the gradient are in units of the new radius.
        const double ratio = double(to[i].radius) * double(scale);
        double unit = ratio;
        for (int power = 0; power < j; ++power) unit *= ratio;
        for (std::size_t c = 0; c < 3; ++c) {
          to[i].coefficients[c][at(j, k)] = unit * double(re[4 * i + c]);
          if (k > 0) to[i].coefficients[c][at(j, k) + 1] = unit * double(im[4 * i + c]);
        }
      }
    }
}

void add_irradiance_at(const LightField& field, PointArrays& points, std::size_t begin, std::size_t end) {
  const Floats d;
  const float inverse_radius = 1.0f / field.radius;
  const V scale = set(inverse_radius);
  for (std::size_t i = begin; i < end; i += hn::Lanes(d)) {
    const V x = hn::Mul(hn::Sub(hn::LoadU(d, &points.x[i]), set(field.center.x)), scale);
    const V y = hn::Mul(hn::Sub(hn::LoadU(d, &points.y[i]), set(field.center.y)), scale);
    const V z = hn::Mul(hn::Sub(hn::LoadU(d, &points.z[i]), set(field.center.z)), scale);
    const V nx = hn::LoadU(d, &points.nx[i]), ny = hn::LoadU(d, &points.ny[i]),
            nz = hn::LoadU(d, &points.nz[i]);
    V s[n_coefficients];
    regular_harmonics(x, y, z, s);
    V sum[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    const auto add = [&](int k, V value) HWY_ATTR {
      for (int c = 0; c < 3; ++c)
        sum[c] = hn::Add(sum[c], hn::Mul(set(static_cast<float>(field.coefficients[c][k])), value));
    };
    // n·∇R_l^m = n_z R_{l−1}^m + ½ (n_x + i n_y) R_{l−1}^{m−1} − ½ (n_x − i n_y) R_{l−1}^{m+1};
    // terms of m > 0 count twice (m and −m).
#pragma GCC unroll 16
    for (int l = 1; l <= order; ++l) {
#pragma GCC unroll 16
      for (int m = 0; m <= l; ++m) {
        const auto re = [&](int n) HWY_ATTR { return s[at(l - 1, n)]; };
        const auto im = [&](int n) HWY_ATTR { return n == 0 ? hn::Zero(d) : s[at(l - 1, n) + 1]; };
        if (m == 0) {
          V value = hn::Mul(nz, re(0));
          if (l > 1) value = hn::Sub(value, hn::Add(hn::Mul(nx, re(1)), hn::Mul(ny, im(1))));
          add(at(l, 0), value);
          continue;
        }
        V value_re = hn::Sub(hn::Mul(nx, re(m - 1)), hn::Mul(ny, im(m - 1)));
        V value_im = hn::Add(hn::Mul(nx, im(m - 1)), hn::Mul(ny, re(m - 1)));
        if (m + 1 < l) {
          value_re = hn::Sub(value_re, hn::Add(hn::Mul(nx, re(m + 1)), hn::Mul(ny, im(m + 1))));
          value_im = hn::Sub(value_im, hn::Sub(hn::Mul(nx, im(m + 1)), hn::Mul(ny, re(m + 1))));
        }
        if (m < l) {
          const V twice = hn::Add(nz, nz);
          value_re = hn::Add(value_re, hn::Mul(twice, re(m)));
          value_im = hn::Add(value_im, hn::Mul(twice, im(m)));
        }
        add(at(l, m), value_re);
        add(at(l, m) + 1, value_im);
      }
    }
    const V unit = hn::Mul(scale, scale);
    hn::StoreU(hn::Add(hn::LoadU(d, &points.r[i]), hn::Mul(sum[0], unit)), d, &points.r[i]);
    hn::StoreU(hn::Add(hn::LoadU(d, &points.g[i]), hn::Mul(sum[1], unit)), d, &points.g[i]);
    hn::StoreU(hn::Add(hn::LoadU(d, &points.b[i]), hn::Mul(sum[2], unit)), d, &points.b[i]);
  }
}

}  // namespace
}  // namespace lambake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lambake {
namespace {
HWY_EXPORT(add_lights_to);
HWY_EXPORT(add_irradiance_at);
HWY_EXPORT(translate_to_four);
}  // namespace

void LightArrays::reserve(std::size_t n) {
  if (index.size() < n + lane_padding) {
    for (std::vector<float>* array : {&x, &y, &z, &r, &g, &b}) array->resize(n + lane_padding);
    index.resize(n + lane_padding);
  }
  size = 0;
}

void PointArrays::resize(std::size_t n) {
  for (std::vector<float>* array : {&x, &y, &z, &nx, &ny, &nz, &r, &g, &b})
    array->resize(n + LightArrays::lane_padding);
}

void add_lights(LightField& field, const LightArrays& lights) {
  field.is_empty = false;
  // Short sums in float, then one addition to the field: the rounding stays below that of 64 additions.
  constexpr std::size_t batch = 1024;
  for (std::size_t begin = 0; begin < lights.size; begin += batch)
    HWY_DYNAMIC_DISPATCH(add_lights_to)(field, lights, begin, std::min(lights.size, begin + batch));
}

void translate(const LightField& from, std::span<LightField> to) {
  for (LightField& field : to) field.is_empty = from.is_empty;
  if (from.is_empty) return;
  for (std::size_t i = 0; i < to.size(); i += 4)
    HWY_DYNAMIC_DISPATCH(translate_to_four)(from, to.subspan(i, std::min<std::size_t>(4, to.size() - i)));
}

void add_irradiance(const LightField& field, PointArrays& points, std::size_t begin, std::size_t end) {
  if (field.is_empty) return;
  HWY_DYNAMIC_DISPATCH(add_irradiance_at)(field, points, begin, end);
}

}  // namespace lambake
#endif  // HWY_ONCE
