// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/camera/picture_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include <fmt/format.h>

#include "twin/base/image.h"

namespace kerfbench::calibrate {
namespace {

constexpr int kLeastContrast = 30;        // Grey levels between the 2nd and the 98th percentile.
constexpr int kLeastWhite = 60;           // Least gray of the 98th percentile.
constexpr double kMostSaturated = 0.005;  // Share of the pixels.
// Rank among the steepest steps: a target has more edges than that, a few hot pixels are fewer.
constexpr double kSteepShare = 0.002;

struct Histogram {
  std::array<std::size_t, 256> count{};
  std::size_t total{};

  void add(int value) {
    ++count[static_cast<std::size_t>(value)];
    ++total;
  }
  /// Value below which this share of all lies.
  [[nodiscard]] int percentile(double share) const {
    const auto wanted = static_cast<std::size_t>(share * static_cast<double>(total));
    std::size_t sum = 0;
    for (std::size_t i = 0; i < count.size(); ++i) {
      sum += count[i];
      if (sum > wanted) return static_cast<int>(i);
    }
    return 255;
  }
};

/// Blur (standard deviation) of a step of this contrast whose steepest slope is that of the steepest steps
/// between pixels two apart: contrast * erf(1 / (blur sqrt 2)).
double blurOf(const GrayImage& image, double contrast) {
  Histogram steps;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 1; x + 1 < image.width; ++x)
      steps.add(std::abs(static_cast<int>(image.at(x + 1, y)) - static_cast<int>(image.at(x - 1, y))));
  }
  const double share = std::min(1.0, steps.percentile(1.0 - kSteepShare) / contrast);
  double low = 0.0;
  double high = 100.0;
  for (int i = 0; i < 40; ++i) {
    const double blur = 0.5 * (low + high);
    (std::erf(1.0 / (blur * std::numbers::sqrt2)) > share ? low : high) = blur;
  }
  return high;
}

}  // namespace

std::string pictureFault(const GrayImage& image) {
  if (image.width < 16 || image.height < 16) return "the picture is empty";
  Histogram levels;
  for (const std::uint8_t pixel : image.pixels) levels.add(pixel);
  const int black = levels.percentile(0.02);
  const int white = levels.percentile(0.98);
  const double saturated = static_cast<double>(levels.count[255]) / static_cast<double>(levels.total);
  if (saturated > kMostSaturated)
    return fmt::format(
        "saturated: {:.1f} % of the pixels are at the top of the scale; less light or exposure",
        100.0 * saturated);
  if (white < kLeastWhite)
    return fmt::format("too dark: its white is grey {} of 255, at least {}; more light or exposure", white,
                       kLeastWhite);
  if (white - black < kLeastContrast)
    return fmt::format("empty: its greys are all within {} … {}, no target is in sight", black, white);
  const double blur_px = blurOf(image, white - black);
  if (blur_px > kMostBlur_px)
    return fmt::format(
        "blurred: its sharpest edges are {:.1f} px wide (sigma), at most {}; focus, or hold the "
        "target still",
        blur_px, kMostBlur_px);
  return {};
}

}  // namespace kerfbench::calibrate
