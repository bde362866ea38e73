// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/corner/corner_raster.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "twin/base/multiversion.h"

namespace kerfbench::vision {
namespace {

constexpr int kAtOnce = 8;  // Floats in a wide register.
constexpr int kMarginSamples = CornerRaster::kSamples * CornerRaster::kMarginPx;

constexpr int filledUp(int count) { return (count + kAtOnce - 1) / kAtOnce * kAtOnce; }

/// Weights of the samples about a pixel: a Gaussian, averaged over the pixel's own two.
std::vector<float> weightsOf(double blur_px) {
  // A pixel's samples stand for its area, and so for a part of the blur.
  constexpr double kOfSamples_px2 = (1.0 - 1.0 / (CornerRaster::kSamples * CornerRaster::kSamples)) / 12.0;
  const double sigma = CornerRaster::kSamples * std::sqrt(std::max(0.01, blur_px * blur_px - kOfSamples_px2));
  const int reach = std::min(kMarginSamples, static_cast<int>(std::ceil(3.5 * sigma)));
  std::vector<double> gauss;
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    gauss.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
    sum += gauss.back();
  }
  std::vector<float> weights;
  double before = 0.0;
  for (const double weight : gauss) {
    weights.push_back(static_cast<float>(0.5 * (before + weight) / sum));
    before = weight;
  }
  weights.push_back(static_cast<float>(0.5 * before / sum));
  return weights;
}

/// A sum of lines, of which each starts where `from` says.
struct WeighedLines {
  std::array<const float*, 2 * (kMarginSamples + 1)> from;
  std::array<float, 2 * (kMarginSamples + 1)> weight;
  std::size_t count;
};

/// Sum of lines at the first `columns` places, a multiple of kAtOnce.
KERFBENCH_WIDE void sumOf(const WeighedLines& lines, int columns, float* to) {
  for (int c = 0; c < columns; c += kAtOnce) {
    std::array<float, kAtOnce> sum{};
    for (std::size_t k = 0; k < lines.count; ++k) {
      const float* const moved = lines.from[k] + c;
      for (std::size_t j = 0; j < kAtOnce; ++j) sum[j] += lines.weight[k] * moved[j];
    }
    std::copy(sum.begin(), sum.end(), to + c);
  }
}

}  // namespace

CornerRaster::CornerRaster(int pixel_columns, int pixel_rows)
    : pixel_columns_(pixel_columns),
      pixel_rows_(pixel_rows),
      plane_(pixel_columns + 2 * kMarginPx),
      // A line of pixels, filled up, is read from as far right as the margin reaches.
      padded_(filledUp(filledUp(pixel_columns) + 2 * kMarginPx)),
      stride_(kSamples * padded_),
      rows_(kSamples * (pixel_rows + 2 * kMarginPx)),
      lines_(static_cast<std::size_t>(stride_)),
      line_(static_cast<std::size_t>(filledUp(pixel_columns))) {}

void CornerRaster::average(const std::vector<float>& samples, double blur_px, std::vector<float>& pixels) {
  const std::vector<float> weights = weightsOf(blur_px);
  const int reach = static_cast<int>(weights.size()) / 2 - 1;
  WeighedLines lines{};
  lines.count = weights.size();
  std::copy(weights.begin(), weights.end(), lines.weight.begin());
  pixels.resize(static_cast<std::size_t>(pixel_columns_) * static_cast<std::size_t>(pixel_rows_));
  for (int r = 0; r < pixel_rows_; ++r) {
    const int first = kMarginSamples - reach;  // First sample of a pixel, within its margin.
    for (int k = 0; k < static_cast<int>(lines.count); ++k)
      lines.from[static_cast<std::size_t>(k)] = samples.data() + (kSamples * r + first + k) * stride_;
    sumOf(lines, stride_, lines_.data());
    for (int k = 0; k < static_cast<int>(lines.count); ++k)
      lines.from[static_cast<std::size_t>(k)] = lines_.data() + indexOf(first + k, 0);
    sumOf(lines, filledUp(pixel_columns_), line_.data());
    std::copy_n(line_.begin(), pixel_columns_,
                pixels.begin() + static_cast<std::ptrdiff_t>(r) * pixel_columns_);
  }
}

}  // namespace kerfbench::vision
