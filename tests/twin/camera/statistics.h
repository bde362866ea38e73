// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "twin/base/image.h"

namespace kerfbench::twin {

/// A rectangle of pixels.
struct Region {
  int x0{}, y0{}, width{}, height{};
};

struct Moments {
  double mean{};
  double rms{};  ///< RMS about the mean.
};

inline Moments momentsOf(const GrayImage& image, const Region& region) {
  double sum = 0.0, square = 0.0;
  for (int y = region.y0; y < region.y0 + region.height; ++y) {
    for (int x = region.x0; x < region.x0 + region.width; ++x) {
      sum += image.gray(x, y);
      square += image.gray(x, y) * image.gray(x, y);
    }
  }
  const double count = static_cast<double>(region.width) * region.height;
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(0.0, square / count - mean * mean))};
}

/// Correlation of a region of one picture with the region of another that lies (dx, dy) further on.
inline double correlationOf(const GrayImage& a, const GrayImage& b, const Region& region, int dx, int dy) {
  const double mean_a = momentsOf(a, region).mean;
  const double mean_b = momentsOf(b, {region.x0 + dx, region.y0 + dy, region.width, region.height}).mean;
  double product = 0.0, square_a = 0.0, square_b = 0.0;
  for (int y = region.y0; y < region.y0 + region.height; ++y) {
    for (int x = region.x0; x < region.x0 + region.width; ++x) {
      const double of_a = a.gray(x, y) - mean_a;
      const double of_b = b.gray(x + dx, y + dy) - mean_b;
      product += of_a * of_b;
      square_a += of_a * of_a;
      square_b += of_b * of_b;
    }
  }
  return product / std::sqrt(square_a * square_b);
}

}  // namespace kerfbench::twin
