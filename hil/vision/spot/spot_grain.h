// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "hil/vision/spot/spot_fit.h"
#include "twin/base/image_fwd.h"

namespace kerfbench::vision {

/// Correlation of neighbouring pixels of plain board: noise alone has nothing in common, the board's grain
/// does. Taken from the surroundings of the spots of all frames so far.
class BoardGrain {
 public:
  /// Looks at the board around a spot: around each of the first hundred, then around every eighth.
  void add(const GrayImage& image, const SpotFit& fit, double board_gray);

  /// Covariance of the spot's centre by all that the board's pixels scatter, in common or each for itself,
  /// and by the shot noise of the spot's own light. The board's grain under the light of the spot is that of
  /// the board around it.
  [[nodiscard]] Eigen::Matrix2d centreCovariance(const SpotFit& fit, const PixelNoise& noise) const;

 private:
  static constexpr int kReach = 4;  ///< Reach within which pixels may have something in common.
  static constexpr int kSide = 2 * kReach + 1;
  // A hundred pictures show some 100 000 pixels, which tell a variance to half a per cent: more of a board
  // would tell no more, and a board that changes is seen by and by.
  static constexpr std::size_t kAllOf = 100;
  static constexpr std::size_t kThenEvery = 8;

  [[nodiscard]] double at(int dc, int dr) const;

  std::size_t shown_{0};
  std::array<double, kSide*(kReach + 1)> products_{};
  std::array<double, kSide*(kReach + 1)> pairs_{};
};

}  // namespace kerfbench::vision
