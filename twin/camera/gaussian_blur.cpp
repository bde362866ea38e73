// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/gaussian_blur.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace kerfbench::twin {
namespace {

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

/// Computes out[x] for x in [begin, end) of a row, or of several columns at once: taps over neighbours `step`
/// apart.
void convolve(const float* in, std::ptrdiff_t step, int count, const std::vector<float>& taps, float* out) {
  for (int x = 0; x < count; ++x) out[x] = taps[0] * in[x];
  for (std::size_t i = 1; i < taps.size(); ++i) {
    const float tap = taps[i];
    const std::ptrdiff_t away = static_cast<std::ptrdiff_t>(i) * step;
    const float* const before = in - away;
    const float* const after = in + away;
    for (int x = 0; x < count; ++x) out[x] += tap * (before[x] + after[x]);
  }
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
  const auto at = [width](int x, int y) { return static_cast<std::ptrdiff_t>(y) * width + x; };
  struct Block {
    int x0, x1, y0, y1;
  };
  std::vector<Block> work;
  for (int by = 0; by < rows; ++by) {
    for (int bx = 0; bx < columns; ++bx) {
      if (!drawnNear(bx, by)) continue;
      const auto ix = static_cast<std::size_t>(bx);
      const auto iy = static_cast<std::size_t>(by);
      work.push_back({edges_x[ix], edges_x[ix + 1], edges_y[iy], edges_y[iy + 1]});
    }
  }

  // The first pass goes across into `smeared`, the second down and back into `light`. Next to a border the
  // nearest pixel stands for those outside.
  std::vector<float> smeared = light;
  std::vector<float> padded;
  const int far = reach();
  for (const Block& block : work) {
    const int count = block.x1 - block.x0;
    padded.resize(static_cast<std::size_t>(count + 2 * far));
    for (int y = block.y0; y < block.y1; ++y) {
      for (int x = -far; x < count + far; ++x) {
        padded[static_cast<std::size_t>(x + far)] =
            light[static_cast<std::size_t>(at(std::clamp(block.x0 + x, 0, width - 1), y))];
      }
      convolve(padded.data() + far, 1, count, taps_, smeared.data() + at(block.x0, y));
    }
  }
  for (const Block& block : work) {
    const int count = block.x1 - block.x0;
    const int padded_rows = block.y1 - block.y0 + 2 * far;
    padded.resize(static_cast<std::size_t>(count) * static_cast<std::size_t>(padded_rows));
    for (int y = 0; y < padded_rows; ++y) {
      const float* const from = smeared.data() + at(block.x0, std::clamp(block.y0 + y - far, 0, height - 1));
      std::copy_n(from, count, padded.data() + static_cast<std::ptrdiff_t>(y) * count);
    }
    for (int y = block.y0; y < block.y1; ++y) {
      convolve(padded.data() + static_cast<std::ptrdiff_t>(y - block.y0 + far) * count, count, count, taps_,
               light.data() + at(block.x0, y));
    }
  }
}

}  // namespace kerfbench::twin
