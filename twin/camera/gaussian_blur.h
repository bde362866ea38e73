// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace kerfbench::twin {

/// Blur by the area of a pixel: standard deviation 1/sqrt(12) px.
inline constexpr double kPixelSigma = 0.2887;

/// A small Gaussian blur of a picture that is flat nearly everywhere. The sampled kernel has exactly the
/// requested variance; a variance of zero or less blurs nothing.
class GaussianBlur {
 public:
  static constexpr std::size_t kWidestBlock = 16;  ///< Width of a block at most, px.

  explicit GaussianBlur(double variance_px2);

  /// Blurs in place. Blocks are [edges_x[i], edges_x[i + 1]) x [edges_y[j], edges_y[j + 1]). Blocks that are
  /// not `drawn` (row-major) all hold one and the same level; only their borders with drawn ones are
  /// processed. @throws std::invalid_argument for a block that is wider than kWidestBlock.
  void apply(std::vector<float>& light, int width, int height, const std::vector<int>& edges_x,
             const std::vector<int>& edges_y, const std::vector<char>& drawn) const;
  /// Reach in pixels to each side.
  [[nodiscard]] int reach() const { return static_cast<int>(taps_.size()) - 1; }

 private:
  std::vector<float> taps_;  ///< Weights from the centre outwards.
};

}  // namespace kerfbench::twin
