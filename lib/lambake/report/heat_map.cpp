#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/report/report.h"

namespace lambake {
namespace {

/// The colours of the map, sRGB 8 bit. Blue and red get darker alike on both sides of white: the sign reads
/// with red-green blindness too, the size reads in black and white.
constexpr std::array<std::array<double, 3>, 9> diverging = {{{8, 48, 107},
                                                             {33, 102, 172},
                                                             {67, 147, 195},
                                                             {146, 197, 222},
                                                             {247, 247, 247},
                                                             {244, 165, 130},
                                                             {214, 96, 77},
                                                             {178, 24, 43},
                                                             {103, 0, 13}}};
constexpr Srgb8 uncovered{58, 60, 66};
constexpr Srgb8 nonfinite{255, 0, 255};
constexpr Srgb8 strip_color{24, 25, 28};
constexpr Srgb8 ink{236, 236, 232};

/// t in [−1, 1]: −1 darker, 1 brighter.
LinearRgb diverging_color(double t) {
  const double at = (std::clamp(t, -1.0, 1.0) + 1) / 2 * (diverging.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(at), diverging.size() - 2);
  const double f = at - static_cast<double>(low);
  std::array<float, 3> linear;
  for (std::size_t c = 0; c < 3; ++c)
    linear[c] =
        static_cast<float>(srgb_decode(((1 - f) * diverging[low][c] + f * diverging[low + 1][c]) / 255));
  return {linear[0], linear[1], linear[2]};
}

double on_screen(float linear) {
  return srgb_encode(std::clamp(static_cast<double>(linear), 0.0, 1.0));
}

/// test − reference on screen, of the channel with the largest |d|; NaN where a side is not finite.
double largest_difference(const LinearRgb& test, const LinearRgb& reference) {
  if (!is_finite(test) || !is_finite(reference)) return NAN;
  const double d[3] = {on_screen(test.r) - on_screen(reference.r), on_screen(test.g) - on_screen(reference.g),
                       on_screen(test.b) - on_screen(reference.b)};
  return *std::max_element(d, d + 3, [](double a, double b) { return std::abs(a) < std::abs(b); });
}

void check_sizes(const Picture& test, const Picture& reference, const Visibility& visibility) {
  const auto is_same = [&](std::uint32_t width, std::uint32_t height) {
    return test.width == width && test.height == height;
  };
  if (!is_same(reference.width, reference.height) || !is_same(visibility.width, visibility.height))
    throw InvalidOption(fmt::format("heat map: expected pictures of {}x{}, found {}x{} and {}x{}", test.width,
                                    test.height, reference.width, reference.height, visibility.width,
                                    visibility.height));
}

/// Letters of 5×7 dots, a row a number, the leftmost dot its highest bit.
struct Glyph {
  char letter;
  std::array<std::uint8_t, 7> rows;
};

constexpr std::array<Glyph, 24> glyphs = {
    {{'0', {14, 17, 19, 21, 25, 17, 14}}, {'1', {4, 12, 4, 4, 4, 4, 14}},
     {'2', {14, 17, 1, 2, 4, 8, 31}},     {'3', {31, 2, 4, 2, 1, 17, 14}},
     {'4', {2, 6, 10, 18, 31, 2, 2}},     {'5', {31, 16, 30, 1, 1, 17, 14}},
     {'6', {6, 8, 16, 30, 17, 17, 14}},   {'7', {31, 1, 2, 4, 8, 8, 8}},
     {'8', {14, 17, 17, 14, 17, 17, 14}}, {'9', {14, 17, 17, 15, 1, 2, 12}},
     {'+', {0, 4, 4, 31, 4, 4, 0}},       {'-', {0, 0, 0, 31, 0, 0, 0}},
     {'/', {0, 1, 2, 4, 8, 16, 0}},       {'.', {0, 0, 0, 0, 0, 12, 12}},
     {'A', {14, 17, 17, 31, 17, 17, 17}}, {'B', {30, 17, 17, 30, 17, 17, 30}},
     {'D', {30, 17, 17, 17, 17, 17, 30}}, {'E', {31, 16, 16, 30, 16, 16, 31}},
     {'G', {14, 17, 16, 23, 17, 17, 14}}, {'H', {17, 17, 17, 31, 17, 17, 17}},
     {'I', {14, 4, 4, 4, 4, 4, 14}},      {'K', {17, 18, 20, 24, 20, 18, 17}},
     {'R', {30, 17, 17, 30, 20, 18, 17}}, {'T', {31, 4, 4, 4, 4, 4, 4}}}};
constexpr int glyph_advance = 6, glyph_height = 7;

int text_width(std::string_view text, int dot) {
  return (static_cast<int>(text.size()) * glyph_advance - 1) * dot;
}

void fill(Picture& picture, int x0, int y0, int width, int height, const LinearRgb& color) {
  for (int y = std::max(0, y0); y < std::min(static_cast<int>(picture.height), y0 + height); ++y)
    for (int x = std::max(0, x0); x < std::min(static_cast<int>(picture.width), x0 + width); ++x)
      picture.pixels[static_cast<std::size_t>(y) * picture.width + static_cast<std::size_t>(x)] = color;
}

void draw_text(Picture& picture, int x, int y, std::string_view text, int dot) {
  for (const char letter : text) {
    const auto glyph =
        std::find_if(glyphs.begin(), glyphs.end(), [&](const Glyph& g) { return g.letter == letter; });
    if (glyph != glyphs.end())
      for (int row = 0; row < glyph_height; ++row)
        for (int column = 0; column < 5; ++column)
          if (glyph->rows[static_cast<std::size_t>(row)] >> (4 - column) & 1)
            fill(picture, x + column * dot, y + row * dot, dot, dot, to_linear(ink));
    x += glyph_advance * dot;
  }
}

/// The strip below the map: the bar from −scale to +scale, its numbers below, the words at its ends above.
void draw_bar(Picture& picture, int top, int dot, double scale) {
  const int width = static_cast<int>(picture.width);
  fill(picture, 0, top, width, static_cast<int>(picture.height) - top, to_linear(strip_color));
  const int margin = std::min(width / 8, 20 * dot);
  const int bar_width = std::max(1, std::min(width - 2 * margin, 260 * dot));
  const int x0 = (width - bar_width) / 2;
  int y = top + 3 * dot;
  const auto right_aligned = [&](int right, std::string_view text) {
    draw_text(picture, right - text_width(text, dot), y, text, dot);
  };
  if (text_width("DARKER BRIGHTER", dot) <= bar_width) {
    draw_text(picture, x0, y, "DARKER", dot);
    right_aligned(x0 + bar_width, "BRIGHTER");
  }
  y += (glyph_height + 2) * dot;
  for (int x = 0; x < bar_width; ++x)
    fill(picture, x0 + x, y, 1, 8 * dot, diverging_color(bar_width > 1 ? 2.0 * x / (bar_width - 1) - 1 : 0));
  y += 8 * dot;
  for (const int x : {0, bar_width / 4, bar_width / 2, bar_width - 1 - bar_width / 4, bar_width - 1})
    fill(picture, x0 + x - dot / 2, y, std::max(1, dot / 2), 2 * dot, to_linear(ink));
  y += 3 * dot;
  const auto centred = [&](int x, std::string_view text) {
    const int w = text_width(text, dot);
    draw_text(picture, std::clamp(x - w / 2, 0, std::max(0, width - w)), y, text, dot);
  };
  const double steps = scale * 255;
  const std::string low = fmt::format("-{:.4g}/255", steps), high = fmt::format("+{:.4g}/255", steps);
  centred(x0, low);
  centred(x0 + bar_width / 2, "0");
  centred(x0 + bar_width, high);
  const std::string half = fmt::format("{:.4g}", steps / 2);
  if (2 * text_width(low, dot) + 2 * text_width(half, dot) <= bar_width) {
    centred(x0 + bar_width / 4, "-" + half);
    centred(x0 + bar_width - bar_width / 4, "+" + half);
  }
}

}  // namespace

double heat_map_scale(const Picture& test, const Picture& reference, const Visibility& visibility) {
  check_sizes(test, reference, visibility);
  std::vector<double> sizes;
  sizes.reserve(visibility.n_covered);
  for (std::size_t i = 0; i < test.pixels.size(); ++i) {
    if (visibility.triangles[i] == no_triangle) continue;
    const double d = std::abs(largest_difference(test.pixels[i], reference.pixels[i]));
    if (std::isfinite(d)) sizes.push_back(d);
  }
  double p99 = 0;
  if (!sizes.empty()) {
    const auto at = sizes.begin() + static_cast<std::ptrdiff_t>((sizes.size() - 1) * 99 / 100);
    std::nth_element(sizes.begin(), at, sizes.end());
    p99 = *at;
  }
  for (const double steps : {1, 2, 4, 8, 16, 32, 64, 128})
    if (p99 <= steps / 255) return steps / 255;
  return 1;
}

Picture heat_map(const Picture& test, const Picture& reference, const Visibility& visibility, double scale) {
  check_sizes(test, reference, visibility);
  if (!(scale > 0)) scale = heat_map_scale(test, reference, visibility);
  // One dot of the letters per 480 pixels of the smaller side, so that they read at every size.
  const int dot = std::max(1, static_cast<int>((std::min(test.width, test.height) + 240) / 480));
  Picture map{test.width, test.height + static_cast<std::uint32_t>(33 * dot), {}};
  map.pixels.resize(static_cast<std::size_t>(map.width) * map.height);
  parallel_blocks(test.pixels.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (visibility.triangles[i] == no_triangle) {
        map.pixels[i] = to_linear(uncovered);
        continue;
      }
      const double d = largest_difference(test.pixels[i], reference.pixels[i]);
      map.pixels[i] = std::isfinite(d) ? diverging_color(d / scale) : to_linear(nonfinite);
    }
  });
  draw_bar(map, static_cast<int>(test.height), dot, scale);
  return map;
}

}  // namespace lambake
