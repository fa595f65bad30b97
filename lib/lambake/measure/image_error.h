#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lambake/core/color.h"
#include "lambake/render/visibility.h"
#include "lambake/scene/picture.h"

namespace lambake {

/// Difference of two pictures over the pixels that the model covers. One channel value is one sample: N =
/// 3·pixels. `linear` differences are of the linear values as they are; `display` ones of the sRGB-encoded
/// values clamped to [0,1], unquantised, so that 1/255 is one step of a screen.
struct ImageError {
  double rmse = 0;                     ///< sqrt(Σ d² / N).
  double mae = 0;                      ///< Σ |d| / N.
  double mean = 0;                     ///< Σ d / N, signed: test − reference.
  double max = 0;                      ///< max |d|.
  std::uint32_t max_x = 0, max_y = 0;  ///< The pixel of `max`: the first in reading order.
  std::size_t max_view = 0;            ///< The view that it is in, of those taken together.
  double p99 = 0;                      ///< 99th percentile of the pixels' largest channel difference.
  double psnr_db = 0;                  ///< 20·log10(1 / rmse); infinity when rmse is 0.
  std::size_t pixels = 0;              ///< Compared.
  std::size_t pixels_over_1_255 = 0;   ///< With a channel off by more than 1/255.
  std::size_t nonfinite =
      0;  ///< Samples that are NaN or infinite on a side: counted, and left out of the rest.
  std::array<std::size_t, 256> histogram{};  ///< Pixels by their largest channel difference in steps of 1/255
                                             ///< (rounded; the last takes the rest).
};

/// Compares `test` with `reference` where `visibility` is covered.
/// @throws InvalidOption if sizes differ.
ImageError compare_pictures(const Picture& test, const Picture& reference, const Visibility& visibility,
                            ErrorSpace space);

/// The errors of several views taken together: as if their pixels were those of one picture (p99 is the
/// largest).
ImageError combine(const std::vector<ImageError>& views);

}  // namespace lambake
