// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/image/window_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "hil/vision/image/level_histogram.h"
#include "twin/base/image.h"
#include "twin/base/multiversion.h"

namespace kerfbench::vision {
namespace {

using Histogram = std::array<int, 256>;

constexpr int kSampleRows = 2;  // Every other row and pixel tells enough.
constexpr int kTriedPx = 8;     // Reach of what was tried already.

void addLevels(const GrayImage& window, Histogram& levels, Histogram& steps) {
  for (int r = 0; r < window.height; r += kSampleRows) {
    const std::uint8_t* const row =
        window.pixels.data() + static_cast<std::size_t>(r) * static_cast<std::size_t>(window.width);
    for (int c = 0; c + 1 < window.width; c += 2) {
      ++levels[row[c]];
      ++steps[static_cast<std::size_t>(std::abs(row[c] - row[c + 1]))];
    }
  }
}

/// Sums of 2 x 2 pixels of two rows.
KERFBENCH_WIDE void sumSquares(const std::uint8_t* upper, const std::uint8_t* lower, std::uint16_t* out,
                               std::size_t count) {
  for (std::size_t c = 0; c < count; ++c)
    out[c] = static_cast<std::uint16_t>(upper[c] + upper[c + 1] + lower[c] + lower[c + 1]);
}

KERFBENCH_WIDE std::uint16_t highestOf(const std::uint16_t* values, std::size_t count) {
  std::uint16_t best = 0;
  for (std::size_t i = 0; i < count; ++i) best = std::max(best, values[i]);
  return best;
}

}  // namespace

WindowLevels levelsOf(std::span<const GrayImage> windows) {
  Histogram levels{};
  Histogram steps{};
  WindowLevels found;
  for (const GrayImage& window : windows) {
    if (window.pixels.empty()) continue;
    addLevels(window, levels, steps);
  }
  long long total = 0;
  for (const int n : levels) total += n;
  found.median = quantile(levels, 0.5);
  found.noise = noiseBySteps(steps);
  found.saturated_share =
      static_cast<double>(levels[254] + levels[255]) / static_cast<double>(std::max(1LL, total));
  found.lifeless = withoutSteps(steps, total);
  return found;
}

int medianOf(const GrayImage& window) {
  if (window.pixels.empty()) return 0;
  Histogram levels{};
  Histogram steps{};
  addLevels(window, levels, steps);
  return quantile(levels, 0.5);
}

std::optional<BrightPeak> brightestOf(const GrayImage& window, int board, double noise,
                                      std::span<const BrightPeak> tried) {
  if (window.width < 2 || window.height < 2) return std::nullopt;
  const auto columns = static_cast<std::size_t>(window.width - 1);
  std::vector<std::uint16_t> sums(columns);
  // The mean of four pixels has half of the noise: 4.5 sigma of the few thousand that a window has.
  const double least = std::max(5.0, 2.25 * noise);
  int best = static_cast<int>(std::ceil(4.0 * (board + least)));
  std::optional<BrightPeak> peak;
  for (int r = 0; r + 1 < window.height; ++r) {
    const std::uint8_t* const row =
        window.pixels.data() + static_cast<std::size_t>(r) * static_cast<std::size_t>(window.width);
    sumSquares(row, row + window.width, sums.data(), columns);
    for (const BrightPeak& other : tried) {
      if (std::abs(r + window.top - other.row) > kTriedPx) continue;
      const int first = std::max(0, other.column - kTriedPx - window.left);
      const int last = std::min(window.width - 2, other.column + kTriedPx - window.left);
      for (int c = first; c <= last; ++c) sums[static_cast<std::size_t>(c)] = 0;
    }
    const int highest = highestOf(sums.data(), columns);
    if (highest <= best) continue;
    best = highest;
    const auto column = static_cast<int>(std::ranges::find(sums, highest) - sums.begin());
    peak = BrightPeak{column + window.left, r + window.top, highest / 4 - board};
  }
  return peak;
}

}  // namespace kerfbench::vision
