// SPDX-License-Identifier: Apache-2.0
// HeadFitter: which marks are false.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/LU>

#include "hil/calibrate/head/head_fitter.h"
#include "hil/calibrate/head/head_parameters.h"
#include "hil/calibrate/head/observation.h"
#include "hil/calibrate/head/spread.h"
#include "twin/base/statistics.h"

namespace kerfbench::calibrate {
namespace {

constexpr double kFewFalse = 2.0;     // False marks among any number: two that were taken for each other.
constexpr double kWorstShare = 0.25;  // Share of the worst distance²: those are rejected together.

}  // namespace

HeadFitter::SurfaceModes HeadFitter::surfaceModes() const {
  const Eigen::Index m = basis_values_.cols();
  const auto values = basis_values_.transpose();
  const auto x = joint_.covariance_root.middleRows(kHeadColumns, m).transpose();
  const auto y = joint_.covariance_root.bottomRows(m).transpose();
  SurfaceModes modes{Eigen::MatrixXd(x.rows(), values.cols()), Eigen::MatrixXd(y.rows(), values.cols())};
  modes.x.topRows<kHeadColumns>().noalias() = x.topRows<kHeadColumns>() * values;
  modes.x.middleRows(kHeadColumns, m) = x.middleRows(kHeadColumns, m).triangularView<Eigen::Lower>() * values;
  modes.x.bottomRows(m).noalias() = x.bottomRows(m) * values;
  modes.y.topRows<kHeadColumns>().noalias() = y.topRows<kHeadColumns>() * values;
  modes.y.middleRows(kHeadColumns, m).setZero();  // Coefficients of x alone.
  modes.y.bottomRows(m) = y.bottomRows(m).triangularView<Eigen::Lower>() * values;
  return modes;
}

void HeadFitter::predictMarks(Eigen::VectorXd& residuals, Eigen::MatrixXd& modes) const {
  const Eigen::Index unknowns = joint_.unknowns.size();
  // What a sheet's marks share is known from them too, the better the more there are.
  const Eigen::MatrixXd reach = gathered_->sharedReach(shared_);
  const Eigen::MatrixXd slopes = gathered_->sharedSlopes();
  const Eigen::VectorXd shared = slopes.rightCols<1>() - slopes.leftCols(unknowns) * joint_.unknowns;
  residuals = rows_.col(kHeadColumns) -
              rows_.leftCols<kHeadColumns>() * joint_.unknowns.head<kHeadColumns>() -
              reach.transpose() * shared;
  modes = Eigen::MatrixXd::Zero(unknowns + reach.rows(), rows_.rows());
  const auto model_root = joint_.covariance_root.topLeftCorner<kHeadColumns, kHeadColumns>().transpose();
  modes.topRows<kHeadColumns>() =
      model_root.triangularView<Eigen::Lower>() * rows_.leftCols<kHeadColumns>().transpose();
  if (prior_) addSurface(residuals, modes);
  modes.topRows(unknowns).noalias() -=
      (slopes.leftCols(unknowns) * joint_.covariance_root).transpose() * reach;
  modes.bottomRows(reach.rows()) = reach;
}

void HeadFitter::addSurface(Eigen::VectorXd& residuals, Eigen::MatrixXd& modes) const {
  const Eigen::Index m = basis_values_.cols();
  const SurfaceModes surface = surfaceModes();
  const Eigen::MatrixXd fitted_mm = basis_values_ * joint_.unknowns.tail(2 * m).reshaped(m, 2);
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    const auto mark = static_cast<Eigen::Index>(i);
    const Eigen::Matrix2d& w = marks_[i].whitening_1_mm;
    residuals.segment<2>(2 * mark) -= w * fitted_mm.row(mark).transpose();
    for (Eigen::Index k = 0; k < 2; ++k) {
      modes.col(2 * mark + k).head(surface.x.rows()) +=
          w(k, 0) * surface.x.col(mark) + w(k, 1) * surface.y.col(mark);
    }
  }
}

bool HeadFitter::judge(bool may_return) {
  std::vector<double> distances;
  noise_chi2_ = 0.0;
  noise_freedom_ = 0.0;
  // Residual and modes, a column for each row of a mark.
  Eigen::MatrixXd modes;
  Eigen::VectorXd residuals;
  predictMarks(residuals, modes);
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    HeadMarkFinding& finding = findings_[i];
    const auto row = 2 * static_cast<Eigen::Index>(i);
    const Eigen::Vector2d residual = residuals.segment<2>(row);
    const double across = modes.col(row).dot(modes.col(row + 1));
    Eigen::Matrix2d predicted;
    predicted << modes.col(row).squaredNorm(), across, across, modes.col(row + 1).squaredNorm();
    finding.residual_mm = marks_[i].whitening_1_mm.inverse() * residual;
    // The residual of a mark that was used is smaller than what the others would leave: by leverage.
    const double sign = used_[i] ? -1.0 : 1.0;
    finding.distance2 =
        lands_[i] ? distance2(residual, Eigen::Matrix2d::Identity() + sign * predicted) : INFINITY;
    if (!used_[i]) continue;
    distances.push_back(finding.distance2);
    noise_chi2_ += residual.squaredNorm();
    noise_freedom_ += 2.0 - predicted.trace();
  }
  const double scale2 = std::max(1.0, upperMedianOf(distances) / kMedianChiSquare2);
  const double limit =
      scale2 * chiSquare2Above(options_.rejection_chance / static_cast<double>(marks_.size()));
  const double worst = *std::ranges::max_element(distances);
  bool changed = false;
  for (std::size_t i = 0; i < used_.size(); ++i) {
    const double d2 = findings_[i].distance2;
    const bool use = used_[i] ? d2 <= limit || d2 < kWorstShare * worst : d2 <= limit && may_return;
    changed = changed || use != used_[i];
    used_[i] = use;
  }
  if (changed) forgetGathered();
  return changed;
}

void HeadFitter::refuseTooMany() const {
  const std::size_t rejected = used_.size() - usedCount();
  const double most = options_.most_false_share * static_cast<double>(used_.size());
  if (static_cast<double>(rejected) <= std::max(kFewFalse, most) && usedCount() >= kLeastMarks) return;
  std::string text = fmt::format("{} of {} marks do not fit to the others", rejected, used_.size());
  std::size_t told = 0;
  for (std::size_t i = 0; i < used_.size() && told < 10; ++i) {
    if (used_[i]) continue;
    const HeadObservation& o = observations_[i];
    text += fmt::format("\n{} aimed at ({:.3f}, {:.3f}) was measured at ({:.3f}, {:.3f}) mm",
                        o.mark ? fmt::format("mark {}", *o.mark) : "a mark", o.aim_W_mm.x(), o.aim_W_mm.y(),
                        o.measured_W_mm.x(), o.measured_W_mm.y());
    ++told;
  }
  if (told < rejected) text += fmt::format("\nand {} more", rejected - told);
  throw HeadCalibrationError(text);
}

}  // namespace kerfbench::calibrate
