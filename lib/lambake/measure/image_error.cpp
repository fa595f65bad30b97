#include "lambake/measure/image_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lambake/core/error.h"

namespace lambake {
namespace {

void check_size(const Picture& picture, const Visibility& visibility) {
  if (picture.width != visibility.width || picture.height != visibility.height)
    throw InvalidOption(fmt::format("compare: expected a picture of {}x{} pixels, found {}x{}",
                                    visibility.width, visibility.height, picture.width, picture.height));
}

/// Sums that ImageError's means are made from, so that views can be added.
struct Sums {
  double squares = 0, magnitudes = 0, differences = 0, samples = 0;
};

void set_means(ImageError& error, const Sums& sums) {
  const double n = std::max(1.0, sums.samples);
  error.rmse = std::sqrt(sums.squares / n);
  error.mae = sums.magnitudes / n;
  error.mean = sums.differences / n;
  error.psnr_db = error.rmse > 0 ? -20 * std::log10(error.rmse) : std::numeric_limits<double>::infinity();
}

/// The smallest value that at least 99 % of `values` do not exceed. Reorders them.
double percentile_99(std::vector<float>& values) {
  if (values.empty()) return 0;
  const std::size_t rank = (99 * values.size() + 99) / 100 - 1;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank), values.end());
  return values[rank];
}

}  // namespace

ImageError compare_pictures(const Picture& test, const Picture& reference, const Visibility& visibility,
                            ErrorSpace space) {
  check_size(test, visibility);
  check_size(reference, visibility);
  ImageError error;
  Sums sums;
  std::vector<float> largest_of_pixels;
  largest_of_pixels.reserve(visibility.n_covered);
  for (std::size_t i = 0; i < visibility.triangles.size(); ++i) {
    if (visibility.triangles[i] == no_triangle) continue;
    ++error.pixels;
    const LinearRgb &a = test.pixels[i], &b = reference.pixels[i];
    const float test_channels[] = {a.r, a.g, a.b}, reference_channels[] = {b.r, b.g, b.b};
    double largest = -1;
    for (int c = 0; c < 3; ++c) {
      if (!std::isfinite(test_channels[c]) || !std::isfinite(reference_channels[c])) {
        ++error.nonfinite;
        continue;
      }
      const double d =
          compared(double(test_channels[c]), space) - compared(double(reference_channels[c]), space);
      sums.squares += d * d;
      sums.magnitudes += std::abs(d);
      sums.differences += d;
      sums.samples += 1;
      largest = std::max(largest, std::abs(d));
    }
    if (largest < 0) continue;  // no finite channel
    if (largest > error.max) {
      error.max = largest;
      error.max_x = static_cast<std::uint32_t>(i % visibility.width);
      error.max_y = static_cast<std::uint32_t>(i / visibility.width);
    }
    error.pixels_over_1_255 += largest > 1.0 / 255.0;
    ++error.histogram[static_cast<std::size_t>(std::min(255.0, std::floor(largest * 255 + 0.5)))];
    largest_of_pixels.push_back(static_cast<float>(largest));
  }
  set_means(error, sums);
  error.p99 = std::min(error.max, percentile_99(largest_of_pixels));  // Which are rounded to float.
  return error;
}

ImageError combine(const std::vector<ImageError>& views) {
  ImageError all;
  Sums sums;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const ImageError& view = views[i];
    const double n = 3.0 * static_cast<double>(view.pixels) - static_cast<double>(view.nonfinite);
    sums.squares += view.rmse * view.rmse * n;
    sums.magnitudes += view.mae * n;
    sums.differences += view.mean * n;
    sums.samples += n;
    if (view.max > all.max)
      all.max = view.max, all.max_x = view.max_x, all.max_y = view.max_y, all.max_view = i;
    all.p99 = std::max(all.p99, view.p99);
    all.pixels += view.pixels;
    all.pixels_over_1_255 += view.pixels_over_1_255;
    all.nonfinite += view.nonfinite;
    for (std::size_t k = 0; k < all.histogram.size(); ++k) all.histogram[k] += view.histogram[k];
  }
  set_means(all, sums);
  return all;
}

}  // namespace lambake
