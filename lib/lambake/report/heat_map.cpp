#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "lambake/report/difference.h"
#include "lambake/report/report.h"

namespace lambake {
namespace {

constexpr Srgb8 strip_color{24, 25, 28};
constexpr Srgb8 ink{236, 236, 232};

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
  return scale_of(screen_difference(test, reference, visibility), visibility);
}

Picture heat_map(const Picture& test, const Picture& reference, const Visibility& visibility, double scale) {
  const std::vector<float> differences = screen_difference(test, reference, visibility);
  if (!(scale > 0)) scale = scale_of(differences, visibility);
  // One dot of the letters per 300 pixels of the smaller side, so that they read at every size.
  const int dot = std::max(1, static_cast<int>((std::min(test.width, test.height) + 150) / 300));
  Picture map = color_difference(differences, visibility, scale);
  map.height += static_cast<std::uint32_t>(33 * dot);
  map.pixels.resize(static_cast<std::size_t>(map.width) * map.height);
  draw_bar(map, static_cast<int>(test.height), dot, scale);
  return map;
}

}  // namespace lambake
