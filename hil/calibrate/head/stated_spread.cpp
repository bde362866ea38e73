// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/stated_spread.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "hil/calibrate/head/spread.h"

namespace kerfbench::calibrate {
namespace {

/// In units of what is stated of each mark: its covariance becomes the unit matrix.
struct Whitened {
  Eigen::MatrixXd common;  ///< Two rows for each mark, a column for each error that marks have in common.
  Eigen::Matrix2Xd own;    ///< Covariance of what they have not, two columns for each mark.
  Eigen::VectorXd errors;
};

Whitened whitened(const HeadFit& fit, std::span<const HeadObservation> marks) {
  std::set<int> sheets;
  for (const HeadObservation& o : marks) {
    if (o.shared) sheets.insert(o.shared->sheet);
  }
  Whitened all;
  Eigen::Index row = 0;
  for (const HeadObservation& o : marks) {
    const auto spot = fit.spotOf(o.aim_W_mm);
    const auto modes = fit.modesAt(o.aim_W_mm);
    if (!spot || !modes) continue;
    if (row == 0) {
      const auto rows = 2 * static_cast<Eigen::Index>(marks.size());
      all.common = Eigen::MatrixXd::Zero(rows, modes->cols() + 3 * static_cast<Eigen::Index>(sheets.size()));
      all.own.resize(Eigen::NoChange, rows);
      all.errors.resize(rows);
    }
    auto common = all.common.middleRows<2>(row);
    common.leftCols(modes->cols()) = *modes;
    if (o.shared) {
      const auto sheet = std::distance(sheets.begin(), sheets.find(o.shared->sheet));
      common.middleCols<3>(modes->cols() + 3 * sheet) = o.shared->modes_mm;
    }
    const Eigen::Matrix2d stated = common * common.transpose() + o.covariance_mm2;
    const auto root = stated.llt();
    all.errors.segment<2>(row) = root.matrixL().solve(o.measured_W_mm - spot->p_W_mm);
    all.own.middleCols<2>(row) =
        root.matrixL().solve(root.matrixL().solve(o.covariance_mm2).transpose().eval());
    root.matrixL().solveInPlace(common);
    row += 2;
  }
  all.common.conservativeResize(row, Eigen::NoChange);
  all.own.conservativeResize(Eigen::NoChange, row);
  all.errors.conservativeResize(row);
  return all;
}

/// Sum of squares of all elements of the marks' covariance.
double squaredNorm(const Whitened& all) {
  double sum = (all.common.transpose() * all.common).squaredNorm() + all.own.squaredNorm();
  for (Eigen::Index row = 0; row < all.errors.size(); row += 2) {
    const auto common = all.common.middleRows<2>(row);
    sum += 2.0 * (common * common.transpose()).cwiseProduct(all.own.middleCols<2>(row)).sum();
  }
  return sum;
}

}  // namespace

std::string StatedSpread::words() const {
  return fmt::format("they are off {:.2g} times as far as stated, where chance reaches {:.2g}", ratio,
                     most_ratio);
}

StatedSpread statedSpread(const HeadFit& fit, std::span<const HeadObservation> marks) {
  const Whitened all = whitened(fit, marks);
  StatedSpread spread;
  spread.marks = static_cast<std::size_t>(all.errors.size()) / 2;
  if (spread.marks == 0) return spread;
  const double most = chiSquare2Above(kBeyondEllipse);
  for (Eigen::Index row = 0; row < all.errors.size(); row += 2) {
    if (all.errors.segment<2>(row).squaredNorm() <= most) ++spread.covered;
  }
  const auto values = static_cast<double>(all.errors.size());
  spread.ratio = std::sqrt(all.errors.squaredNorm() / values);
  const double freedom = std::max(1.0, values * values / squaredNorm(all));
  spread.most_ratio = std::sqrt(chiSquareAbove(freedom, kChanceAsNormal) / freedom);
  return spread;
}

}  // namespace kerfbench::calibrate
