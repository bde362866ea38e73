// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/spot/spot_grain.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include <Eigen/LU>

#include "twin/base/image.h"

namespace kerfbench::vision {

void BoardGrain::add(const GrayImage& image, const SpotFit& fit, double board_gray) {
  if (const std::size_t shown = shown_++; shown >= kAllOf && shown % kThenEvery != 0) return;
  constexpr int kHalf = 14;
  const double clear_px = 4.0 * fit.long_sigma_px + 1.0;
  const int half = static_cast<int>(std::ceil(clear_px)) + kHalf;
  const int column = static_cast<int>(std::lround(fit.pixel.x()));
  const int row = static_cast<int>(std::lround(fit.pixel.y()));
  const int left = std::max(image.left, column - half), right = std::min(image.right(), column + half);
  const int top = std::max(image.top, row - half), bottom = std::min(image.bottom(), row + half);
  const int width = right - left + 1;
  const double kNone = std::numeric_limits<double>::quiet_NaN();
  // Print and other light are no board, and neither are their blurred edges.
  constexpr int kEdgePx = 2;
  const double limit = std::max(0.25 * board_gray, 8.0);
  std::vector<double> board(static_cast<std::size_t>(width) * static_cast<std::size_t>(bottom - top + 1));
  const auto placeOf = [&](int c, int r) { return static_cast<std::size_t>((r - top) * width + c - left); };
  for (int r = top; r <= bottom; ++r) {
    for (int c = left; c <= right; ++c) {
      const bool clear = (Eigen::Vector2d(c, r) - fit.pixel).norm() > clear_px;
      if (!clear) board[placeOf(c, r)] = kNone;
      const double off = image.gray(c, r) - board_gray;
      board[placeOf(c, r)] += off;
      if (!clear || std::abs(off) < limit) continue;
      for (int y = std::max(top, r - kEdgePx); y <= std::min(bottom, r + kEdgePx); ++y) {
        for (int x = std::max(left, c - kEdgePx); x <= std::min(right, c + kEdgePx); ++x)
          board[placeOf(x, y)] = kNone;
      }
    }
  }
  double sum = 0.0, count = 0.0;
  for (const double value : board) {
    if (std::isnan(value)) continue;
    sum += value;
    count += 1.0;
  }
  if (count < 200.0) return;
  for (double& value : board) value -= sum / count;
  const int height = bottom - top + 1;
  for (int dr = 0; dr <= kReach; ++dr) {
    for (int dc = dr == 0 ? 0 : -kReach; dc <= kReach; ++dc) {
      double products = 0.0, pairs = 0.0;
      for (int r = 0; r + dr < height; ++r) {
        for (int c = std::max(0, -dc); c < width - std::max(0, dc); ++c) {
          const double product = board[static_cast<std::size_t>(r * width + c)] *
                                 board[static_cast<std::size_t>((r + dr) * width + c + dc)];
          if (std::isnan(product)) continue;
          products += product;
          pairs += 1.0;
        }
      }
      const auto place = static_cast<std::size_t>(dr * kSide + dc + kReach);
      products_[place] += products;
      pairs_[place] += pairs;
    }
  }
}

double BoardGrain::at(int dc, int dr) const {
  if (dr < 0 || (dr == 0 && dc < 0)) return at(-dc, -dr);
  if (dr > kReach || std::abs(dc) > kReach) return 0.0;
  const auto place = static_cast<std::size_t>(dr * kSide + dc + kReach);
  return pairs_[place] > 0.0 ? products_[place] / pairs_[place] : 0.0;
}

Eigen::Matrix2d BoardGrain::centreCovariance(const SpotFit& fit, const PixelNoise& noise) const {
  if (pairs_[kReach] == 0.0) return fit.covariance_px2;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (const SpotFit::Influence& a : fit.influences) {
    covariance += noise.per_gray * a.brighter_gray * a.by_gray * a.by_gray.transpose();
    for (const SpotFit::Influence& b : fit.influences) {
      if (std::abs(a.row - b.row) > kReach || std::abs(a.column - b.column) > kReach) continue;
      covariance += at(b.column - a.column, b.row - a.row) * a.by_gray * b.by_gray.transpose();
    }
  }
  const bool sound = covariance.allFinite() && covariance.determinant() > 0.0;
  return sound && covariance.trace() > 0.8 * fit.covariance_px2.trace() ? covariance : fit.covariance_px2;
}

}  // namespace kerfbench::vision
