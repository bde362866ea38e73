// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_light.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "twin/base/statistics.h"

namespace kerfbench::vision {
namespace {

constexpr double kLeastShare = 0.05;  // Least share of the light to measure in.
constexpr int kRounds = 8;
/// Distance of an outlier, over the board's gray: ink, a mark, a cut that fills a cell.
constexpr double kOutlier = 0.06;
constexpr double kLeastCells = 0.3;  // Least share of the cells that must agree.
constexpr std::size_t kEnough = 24;  // Least number of cells.
constexpr double kLeastGray = 4.0;   // Darker board tells nothing of the light.
constexpr double kLeastStep = 2e-3;  // Least scatter of a step's logarithm.

using Terms = Eigen::Matrix<double, 6, 1>;

/// Gray of the board at a place of the picture.
struct Cell {
  Terms terms;
  double gray{};
};

/// From one cell to its neighbour: change of terms, and of the gray's logarithm.
struct Step {
  Terms terms;
  double log_gray{};
};

/// Weighted by Welsch's rule: what is much farther off than the scale does not count.
template <typename Row, typename Value>
Terms fitRobust(const std::vector<Row>& rows, const Value& valueOf, const Terms& start, double scale,
                double least_scale) {
  Terms fit = start;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Terms right = Terms::Zero();
    for (const Row& row : rows) {
      const double off = (valueOf(row) - row.terms.dot(fit)) / scale;
      const double w = std::exp(-0.5 * off * off);
      normal += w * row.terms * row.terms.transpose();
      right += w * valueOf(row) * row.terms;
    }
    // Steps say nothing of the constant term: the smallest solution has none.
    fit = normal.completeOrthogonalDecomposition().solve(right);
    scale = std::max(least_scale, 0.5 * scale);
  }
  return fit;
}

/// Shape of the light by the steps between neighbours: the same on board and on ink, which lets a share of
/// the light through, so that a printed panel counts at its edges alone. One factor is open.
Terms shapeOf(const std::vector<Cell>& cells, const std::vector<Step>& steps) {
  std::vector<double> sizes;
  for (const Step& step : steps) sizes.push_back(std::abs(step.log_gray));
  const double typical = std::max(kMadToSigma * upperMedianIn(sizes), kLeastStep);
  const Terms log_light = fitRobust(
      steps, [](const Step& step) { return step.log_gray; }, Terms::Zero(), 4.0 * typical, typical);
  // The polynomial that is nearest to its exponential.
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  Terms right = Terms::Zero();
  for (const Cell& cell : cells) {
    normal += cell.terms * cell.terms.transpose();
    right += std::exp(log_light.dot(cell.terms)) * cell.terms;
  }
  return normal.ldlt().solve(right);
}

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
  // The last row and column of cells may be slivers. Those at the rim are filled from further in.
  const int columns = std::max(1, width_px / Background::kCellPx);
  const int rows = std::max(1, height_px / Background::kCellPx);
  const bool large =
      static_cast<std::size_t>(std::max(0, columns - 2)) * static_cast<std::size_t>(std::max(0, rows - 2)) >=
      kEnough;
  const int rim = large ? 1 : 0;
  std::vector<Cell> cells;
  std::vector<Step> steps;
  for (const Background* picture : pictures) {
    const auto cellAt = [&](int i, int j) {
      const Eigen::Vector2d corner(i * Background::kCellPx, j * Background::kCellPx);
      const Eigen::Vector2d middle = corner.array() + 0.5 * (Background::kCellPx - 1);
      return Cell{termsAt(middle), static_cast<double>(picture->at(static_cast<int>(corner.x()),
                                                                   static_cast<int>(corner.y())))};
    };
    for (int j = rim; j < rows - rim; ++j) {
      for (int i = rim; i < columns - rim; ++i) {
        const Cell here = cellAt(i, j);
        cells.push_back(here);
        const auto addStep = [&](const Cell& next) {
          if (std::min(here.gray, next.gray) > kLeastGray)
            steps.push_back({next.terms - here.terms, std::log(next.gray / here.gray)});
        };
        if (i + 1 < columns - rim) addStep(cellAt(i + 1, j));
        if (j + 1 < rows - rim) addStep(cellAt(i, j + 1));
      }
    }
  }
  if (cells.size() < kEnough || steps.size() < kEnough) return;

  const Terms shape = shapeOf(cells, steps);
  std::vector<double> levels;
  for (const Cell& cell : cells) levels.push_back(cell.gray / std::max(kLeastShare, shape.dot(cell.terms)));
  const double typical = upperMedianIn(levels);
  if (!(typical > kLeastGray)) return;
  const Terms fit = fitRobust(
      cells, [](const Cell& cell) { return cell.gray; }, typical * shape, 2.0 * kOutlier * typical,
      kOutlier * typical);
  const auto agree = std::count_if(cells.begin(), cells.end(), [&](const Cell& cell) {
    return std::abs(cell.gray - cell.terms.dot(fit)) < std::max(1.5, 1.5 * kOutlier * typical);
  });
  if (!fit.allFinite() || static_cast<double>(agree) < kLeastCells * static_cast<double>(cells.size()))
    return;
  if (!(fit[0] > kLeastGray)) return;
  share_ = fit / fit[0];
}

}  // namespace kerfbench::vision
