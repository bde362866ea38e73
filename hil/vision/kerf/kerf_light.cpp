// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_light.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>

#include "twin/base/statistics.h"

namespace kerfbench::vision {
namespace {

constexpr double kLeastShare = 0.05;  // Least share of the light to measure in.
constexpr int kRounds = 8;
/// Distance of an outlier, over the board's gray: ink, a mark, a cut that fills a cell.
constexpr double kOutlier = 0.06;
constexpr double kLeastCells = 0.3;  // Least share of the cells that must agree.

struct Cell {
  Eigen::Matrix<double, 6, 1> terms;
  double gray;
};

}  // namespace

LightField::Terms LightField::termsAt(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d d = per_px_ * (pixel - middle_px_);
  return (Terms() << 1.0, d.x(), d.y(), d.x() * d.x(), d.x() * d.y(), d.y() * d.y()).finished();
}

double LightField::at(const Eigen::Vector2d& pixel) const {
  return std::max(kLeastShare, share_.dot(termsAt(pixel)));
}

LightField::LightField(std::span<const Background* const> pictures, int width_px, int height_px)
    : middle_px_(0.5 * (width_px - 1), 0.5 * (height_px - 1)), per_px_(2.0 / std::max(1, width_px)) {
  std::vector<Cell> cells;
  for (const Background* picture : pictures) {
    // The last row and column of cells may be slivers.
    for (int j = 0; j < std::max(1, height_px / Background::kCellPx); ++j) {
      for (int i = 0; i < std::max(1, width_px / Background::kCellPx); ++i) {
        const int column = i * Background::kCellPx;
        const int row = j * Background::kCellPx;
        const Eigen::Vector2d centre(column + 0.5 * Background::kCellPx, row + 0.5 * Background::kCellPx);
        cells.push_back({termsAt(centre), static_cast<double>(picture->at(column, row))});
      }
    }
  }
  if (cells.size() < 24) return;

  std::vector<double> grays;
  for (const Cell& cell : cells) grays.push_back(cell.gray);
  const double typical = upperMedianIn(grays);
  if (!(typical > 4.0)) return;

  // Weighted by Cauchy's rule, narrowing: the median starts it.
  Terms fit = typical * Terms::Unit(0);
  double scale = 0.5 * typical;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Terms right = Terms::Zero();
    for (const Cell& cell : cells) {
      const double off = (cell.gray - cell.terms.dot(fit)) / scale;
      const double w = 1.0 / (1.0 + off * off);
      normal += w * cell.terms * cell.terms.transpose();
      right += w * cell.gray * cell.terms;
    }
    fit = normal.ldlt().solve(right);
    scale = std::max(kOutlier * typical, 0.5 * scale);
  }
  const auto agree = std::count_if(cells.begin(), cells.end(), [&](const Cell& cell) {
    return std::abs(cell.gray - cell.terms.dot(fit)) < std::max(1.5, 1.5 * kOutlier * typical);
  });
  if (!fit.allFinite() || static_cast<double>(agree) < kLeastCells * static_cast<double>(cells.size()))
    return;
  if (!(fit[0] > 4.0)) return;
  share_ = fit / fit[0];
}

}  // namespace kerfbench::vision
