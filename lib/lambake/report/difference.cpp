#include "lambake/report/difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

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
constexpr Srgb8 nonfinite{255, 0, 255};

double largest_difference(const LinearRgb& test, const LinearRgb& reference) {
  if (!is_finite(test) || !is_finite(reference)) return NAN;
  const auto difference = [](double a, double b) {
    return compared(a, ErrorSpace::display) - compared(b, ErrorSpace::display);
  };
  const double d[3] = {difference(test.r, reference.r), difference(test.g, reference.g),
                       difference(test.b, reference.b)};
  return *std::max_element(d, d + 3, [](double a, double b) { return std::abs(a) < std::abs(b); });
}

}  // namespace

std::vector<float> screen_difference(const Picture& test, const Picture& reference,
                                     const Visibility& visibility) {
  const auto is_same = [&](std::uint32_t width, std::uint32_t height) {
    return test.width == width && test.height == height;
  };
  if (!is_same(reference.width, reference.height) || !is_same(visibility.width, visibility.height))
    throw InvalidOption(fmt::format("difference: expected pictures of {}x{}, found {}x{} and {}x{}",
                                    test.width, test.height, reference.width, reference.height,
                                    visibility.width, visibility.height));
  std::vector<float> differences(test.pixels.size(), 0.0f);
  parallel_blocks(differences.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (visibility.triangles[i] != no_triangle)
        differences[i] = static_cast<float>(largest_difference(test.pixels[i], reference.pixels[i]));
  });
  return differences;
}

double scale_of(const std::vector<float>& differences, const Visibility& visibility) {
  std::vector<float> sizes;
  sizes.reserve(visibility.n_covered);
  for (std::size_t i = 0; i < differences.size(); ++i)
    if (visibility.triangles[i] != no_triangle && std::isfinite(differences[i]))
      sizes.push_back(std::abs(differences[i]));
  float p99 = 0;
  if (!sizes.empty()) {
    const auto at = sizes.begin() + static_cast<std::ptrdiff_t>((sizes.size() - 1) * 99 / 100);
    std::nth_element(sizes.begin(), at, sizes.end());
    p99 = *at;
  }
  for (const double steps : {1, 2, 4, 8, 16, 32, 64, 128})
    if (p99 <= steps / 255) return steps / 255;
  return 1;
}

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

std::string diverging_gradient_css() {
  std::string css = "linear-gradient(90deg";
  for (const auto& [r, g, b] : diverging) fmt::format_to(std::back_inserter(css), ", rgb({} {} {})", r, g, b);
  return css + ")";
}

Picture color_difference(const std::vector<float>& differences, const Visibility& visibility, double scale) {
  Picture map{visibility.width, visibility.height, std::vector<LinearRgb>(differences.size())};
  parallel_blocks(differences.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const bool is_covered = visibility.triangles[i] != no_triangle;
      map.pixels[i] = !is_covered                      ? to_linear(uncovered)
                      : !std::isfinite(differences[i]) ? to_linear(nonfinite)
                                                       : diverging_color(differences[i] / scale);
    }
  });
  return map;
}

std::vector<Srgb8> heat_colors(std::span<const float> differences, double scale) {
  std::vector<Srgb8> colors;
  colors.reserve(differences.size());
  for (const float d : differences)
    colors.push_back(std::isfinite(d) ? to_srgb8(diverging_color(d / scale)) : nonfinite);
  return colors;
}

std::vector<WorstPixel> worst_pixels(const std::vector<float>& differences, std::uint32_t width,
                                     std::size_t n, std::uint32_t distance) {
  std::vector<WorstPixel> worst;
  while (worst.size() < n) {
    WorstPixel found;
    for (std::size_t i = 0; i < differences.size(); ++i) {
      if (!(std::abs(differences[i]) > std::abs(found.difference))) continue;
      const auto x = static_cast<std::uint32_t>(i % width), y = static_cast<std::uint32_t>(i / width);
      const bool is_near = std::any_of(worst.begin(), worst.end(), [&](const WorstPixel& w) {
        return std::max(x, w.x) - std::min(x, w.x) < distance &&
               std::max(y, w.y) - std::min(y, w.y) < distance;
      });
      if (!is_near) found = {x, y, differences[i]};
    }
    if (std::abs(found.difference) < 1.0f / 255) break;
    worst.push_back(found);
  }
  return worst;
}

}  // namespace lambake
