// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/gaussian_blur.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <stdexcept>

#include "twin/base/multiversion.h"

namespace kerfbench::twin {
namespace {

constexpr std::size_t kWidest = GaussianBlur::kWidestBlock;

/// Half of the kernel exp(-i²/2s²) with unit sum over both halves.
std::vector<double> halfKernel(double s2, int reach) {
  std::vector<double> taps;
  double sum = 0.0;
  for (int i = 0; i <= reach; ++i) {
    taps.push_back(std::exp(-0.5 * i * i / s2));
    sum += (i == 0 ? 1.0 : 2.0) * taps.back();
  }
  for (double& tap : taps) tap /= sum;
  return taps;
}

double varianceOf(const std::vector<double>& taps) {
  double variance = 0.0;
  for (std::size_t i = 1; i < taps.size(); ++i) variance += 2.0 * taps[i] * static_cast<double>(i * i);
  return variance;
}

/// Computes a row of a block, or less of it: taps over neighbours `step` apart. As many pixels as the widest
/// row has are read, whatever `count` is.
KERFBENCH_WIDE void convolve(const float* in, std::ptrdiff_t step, int count, std::span<const float> taps,
                             float* out) {
  std::array<float, kWidest> sums;
  for (std::size_t x = 0; x < kWidest; ++x) sums[x] = taps[0] * in[x];
  for (std::size_t i = 1; i < taps.size(); ++i) {
    const float tap = taps[i];
    const std::ptrdiff_t away = static_cast<std::ptrdiff_t>(i) * step;
    const float* const before = in - away;
    const float* const after = in + away;
    for (std::size_t x = 0; x < kWidest; ++x) sums[x] += tap * (before[x] + after[x]);
  }
  for (int x = 0; x < count; ++x) out[x] = sums[static_cast<std::size_t>(x)];
}

struct BlurredBlock {
  int x0, x1, y0, y1;
};

/// Blocks that are drawn, or have a neighbour that is.
std::vector<BlurredBlock> blocksToBlur(const std::vector<int>& edges_x, const std::vector<int>& edges_y,
                                       const std::vector<char>& drawn) {
  const auto columns = static_cast<int>(edges_x.size()) - 1;
  const auto rows = static_cast<int>(edges_y.size()) - 1;
  const auto drawnNear = [&](int bx, int by) {
    for (int y = std::max(by - 1, 0); y <= std::min(by + 1, rows - 1); ++y) {
      for (int x = std::max(bx - 1, 0); x <= std::min(bx + 1, columns - 1); ++x) {
        if (drawn[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                  static_cast<std::size_t>(x)] != 0)
          return true;
      }
    }
    return false;
  };
  std::vector<BlurredBlock> work;
  for (int by = 0; by < rows; ++by) {
    for (int bx = 0; bx < columns; ++bx) {
      if (!drawnNear(bx, by)) continue;
      const auto ix = static_cast<std::size_t>(bx);
      const auto iy = static_cast<std::size_t>(by);
      work.push_back({edges_x[ix], edges_x[ix + 1], edges_y[iy], edges_y[iy + 1]});
    }
  }
  return work;
}

}  // namespace

GaussianBlur::GaussianBlur(double variance_px2) {
  if (!(variance_px2 > 1e-6)) {
    taps_ = {1.0F};
    return;
  }
  const int reach = std::max(1, static_cast<int>(std::ceil(3.5 * std::sqrt(variance_px2))));
  // A sampled Gaussian is narrower than its parameter says when that is below a pixel.
  double low = 1e-3;
  double high = 4.0 * variance_px2 + 1.0;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (varianceOf(halfKernel(middle, reach)) < variance_px2 ? low : high) = middle;
  }
  for (const double tap : halfKernel(low, reach)) taps_.push_back(static_cast<float>(tap));
}

void GaussianBlur::apply(std::vector<float>& light, int width, int height, const std::vector<int>& edges_x,
                         const std::vector<int>& edges_y, const std::vector<char>& drawn) const {
  if (taps_.size() < 2) return;
  const std::vector<BlurredBlock> work = blocksToBlur(edges_x, edges_y, drawn);
  if (std::ranges::any_of(work,
                          [](const BlurredBlock& b) { return b.x1 - b.x0 > static_cast<int>(kWidest); }))
    throw std::invalid_argument("GaussianBlur: a block is too wide");
  const auto index = [width](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  };
  const int far = reach();
  // The first pass goes across into `smeared`, the second down and back into `light`. Most of the picture is
  // in neither: its memory is not even touched. Next to a border the nearest pixel stands for those outside.
  const auto smeared = std::make_unique_for_overwrite<float[]>(light.size());
  for (const BlurredBlock& block : work) {
    for (int y = std::max(block.y0 - far, 0); y < std::min(block.y1 + far, height); ++y) {
      for (int x = block.x0; x < block.x1; ++x) smeared[index(x, y)] = light[index(x, y)];
    }
  }
  const int widest = static_cast<int>(kWidest);
  std::vector<float> padded(kWidest + 2 * static_cast<std::size_t>(far));
  for (const BlurredBlock& block : work) {
    const int count = block.x1 - block.x0;
    const bool inside = block.x0 >= far && block.x0 + widest + far <= width;
    for (int y = block.y0; y < block.y1; ++y) {
      const float* from = &light[index(block.x0, y)];
      if (!inside) {
        for (int x = -far; x < widest + far; ++x)
          padded[static_cast<std::size_t>(x + far)] = light[index(std::clamp(block.x0 + x, 0, width - 1), y)];
        from = padded.data() + far;
      }
      convolve(from, 1, count, taps_, &smeared[index(block.x0, y)]);
    }
  }
  std::vector<float> rows;
  for (const BlurredBlock& block : work) {
    const int count = block.x1 - block.x0;
    const int padded_rows = block.y1 - block.y0 + 2 * far;
    rows.resize(kWidest * static_cast<std::size_t>(padded_rows));
    for (int y = 0; y < padded_rows; ++y) {
      const std::size_t from = index(block.x0, std::clamp(block.y0 + y - far, 0, height - 1));
      float* const to = rows.data() + kWidest * static_cast<std::size_t>(y);
      for (int x = 0; x < count; ++x) to[x] = smeared[from + static_cast<std::size_t>(x)];
    }
    for (int y = block.y0; y < block.y1; ++y) {
      convolve(rows.data() + kWidest * static_cast<std::size_t>(y - block.y0 + far), kWidest, count, taps_,
               &light[index(block.x0, y)]);
    }
  }
}

}  // namespace kerfbench::twin
