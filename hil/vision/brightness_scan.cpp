// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/brightness_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>

namespace kerfbench::hil {
namespace {

constexpr int kCell = Background::kCellPx;
constexpr int kSampleStride = 16;

template <std::size_t Bins>
int quantile(const std::array<int, Bins>& histogram, double share) {
  long long total = 0;
  for (const int n : histogram) total += n;
  long long seen = 0;
  for (std::size_t i = 0; i < Bins; ++i) {
    seen += histogram[i];
    if (static_cast<double>(seen) > share * static_cast<double>(total)) return static_cast<int>(i);
  }
  return static_cast<int>(Bins) - 1;
}

/// Means of 2 x 2 pixels, maximum per column: two averaging instructions per 16 pixels.
void foldRows(const std::uint8_t* upper, const std::uint8_t* lower, std::uint8_t* highest,
              std::size_t count) {
  for (std::size_t c = 0; c < count; ++c) {
    const auto left = static_cast<std::uint8_t>((upper[c] + lower[c] + 1) >> 1);
    const auto right = static_cast<std::uint8_t>((upper[c + 1] + lower[c + 1] + 1) >> 1);
    const auto mean = static_cast<std::uint8_t>((left + right + 1) >> 1);
    highest[c] = std::max(highest[c], mean);
  }
}

int mean2x2(const GrayImage& image, int c, int r) {
  const int left = (image.at(c, r) + image.at(c, r + 1) + 1) >> 1;
  const int right = (image.at(c + 1, r) + image.at(c + 1, r + 1) + 1) >> 1;
  return (left + right + 1) >> 1;
}

}  // namespace

Background::Background(const GrayImage& image)
    : columns_((image.width + kCell - 1) / kCell), rows_((image.height + kCell - 1) / kCell) {
  const auto cells = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  std::vector<int> own(cells, 0);
  std::array<int, 256> steps{};
  std::array<int, 256> all{};
  std::vector<std::uint8_t> samples;
  for (int j = 0; j < rows_; ++j) {
    for (int i = 0; i < columns_; ++i) {
      samples.clear();
      const int bottom = std::min(image.height, (j + 1) * kCell);
      const int right = std::min(image.width, (i + 1) * kCell);
      for (int r = j * kCell + (bottom - j * kCell > kSampleStride ? kSampleStride / 2 : 0); r < bottom;
           r += kSampleStride) {
        for (int c = i * kCell; c < right; c += kSampleStride) {
          const std::uint8_t value = image.at(c, r);
          samples.push_back(value);
          ++all[value];
          if (c + 1 < image.width) ++steps[static_cast<std::size_t>(std::abs(value - image.at(c + 1, r)))];
        }
      }
      const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
      std::nth_element(samples.begin(), middle, samples.end());
      own[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(i)] =
          *middle;
    }
  }
  median_ = quantile(all, 0.5);

  // Edges of marks and kerfs make a few big steps: leave them out.
  const int typical = std::max(1, quantile(steps, 0.5));
  double sum = 0.0;
  long long count = 0;
  for (int d = 0; d <= 6 * typical && d < 256; ++d) {
    const int n = steps[static_cast<std::size_t>(d)];
    sum += static_cast<double>(n) * d * d;
    count += n;
  }
  noise_ = std::max(0.3, std::sqrt(sum / static_cast<double>(std::max(1LL, count)) / 2.0));

  level_ = own;
  for (int j = 0; j < rows_; ++j) {
    for (int i = 0; i < columns_; ++i) {
      std::array<int, 9> around{};
      std::size_t n = 0;
      for (int y = std::max(0, j - 1); y <= std::min(rows_ - 1, j + 1); ++y) {
        for (int x = std::max(0, i - 1); x <= std::min(columns_ - 1, i + 1); ++x) {
          around[n++] = own[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                            static_cast<std::size_t>(x)];
        }
      }
      const std::span values(around.data(), n);
      std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(n / 2), values.end());
      int& level = level_[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) +
                          static_cast<std::size_t>(i)];
      level = std::max(level, values[n / 2]);
    }
  }
}

std::vector<BrightPeak> findBrightPeaks(const GrayImage& image, const Background& background,
                                        std::size_t max) {
  struct Candidate {
    BrightPeak peak;
    int cell_x;
    int cell_y;
  };
  // The mean of four pixels has half the noise; 7 sigma leaves less than one false peak in 1e4 pictures. The
  // averaging instruction rounds up, twice.
  const int threshold = static_cast<int>(std::ceil(std::max(6.0, 3.5 * background.noise() + 1.5)));
  std::vector<Candidate> candidates;
  if (image.width < 2 || image.height < 2) return {};
  const auto width = static_cast<std::size_t>(image.width);
  std::vector<std::uint8_t> highest(width);
  for (int top = 0; top < image.height; top += kCell) {
    std::fill(highest.begin(), highest.end(), std::uint8_t{0});
    const int bottom = std::min(image.height - 1, top + kCell);
    for (int r = top; r < bottom; r += 2) {
      const std::uint8_t* upper = image.pixels.data() + static_cast<std::size_t>(r) * width;
      foldRows(upper, upper + width, highest.data(), width - 1);
    }
    for (int left = 0; left < image.width - 1; left += kCell) {
      const auto begin = highest.begin() + left;
      const auto end = highest.begin() + std::min(image.width - 1, left + kCell);
      const auto best = std::max_element(begin, end);
      const int column = static_cast<int>(best - highest.begin());
      const int height = *best - background.at(column, top);
      if (height < threshold) continue;
      for (int r = top; r < bottom; r += 2) {
        if (mean2x2(image, column, r) != *best) continue;
        candidates.push_back({{column, r, height}, left / kCell, top / kCell});
        break;
      }
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.peak.height > b.peak.height; });
  std::vector<Candidate> kept;
  for (const Candidate& c : candidates) {
    if (kept.size() == max) break;
    const bool beside = std::any_of(kept.begin(), kept.end(), [&](const Candidate& k) {
      return std::abs(k.cell_x - c.cell_x) <= 1 && std::abs(k.cell_y - c.cell_y) <= 1;
    });
    if (!beside) kept.push_back(c);
  }
  std::vector<BrightPeak> peaks;
  for (const Candidate& k : kept) peaks.push_back(k.peak);
  return peaks;
}

}  // namespace kerfbench::hil
