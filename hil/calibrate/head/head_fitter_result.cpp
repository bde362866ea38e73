// SPDX-License-Identifier: Apache-2.0
// HeadFitter: the result.
#include <cmath>

#include <Eigen/Cholesky>

#include "hil/calibrate/head/head_fitter.h"
#include "hil/calibrate/head/head_parameters.h"
#include "hil/calibrate/head/observation.h"
#include "hil/calibrate/head/spread.h"

namespace kerfbench::calibrate {
namespace {

constexpr double kNoiseScaledAt = 2.326;  // 1 % of a normal variable lie beyond.
constexpr double kMixedCorrelation = 0.7;
constexpr double kNothingLeft = 1e-10;  // Share of the largest pivot: rounding.

/// R with R Rᵀ = matrix, as many columns as its rank.
Eigen::MatrixXd semidefiniteRoot(const Eigen::MatrixXd& matrix) {
  const Eigen::LDLT<Eigen::MatrixXd> factors(matrix);  // Pivoted: the largest come first.
  const Eigen::VectorXd pivots = factors.vectorD();
  Eigen::Index rank = 0;
  while (rank < pivots.size() && pivots[rank] > kNothingLeft * pivots[0]) ++rank;
  const Eigen::MatrixXd lower = factors.matrixL();
  return factors.transpositionsP().transpose() *
         Eigen::MatrixXd(lower.leftCols(rank) * pivots.head(rank).cwiseSqrt().asDiagonal());
}

}  // namespace

HeadFit HeadFitter::result() const {
  HeadFit fit(nominal_, design_);
  fit.axes_ = axes_;
  fit.departures_ = tolerances_.cwiseProduct(scaled_);
  if (prior_) {
    const Eigen::Index m = basis_->size();
    fit.surface_ = HeadSurface{*basis_, prior_->amplitude_mm, prior_->decay, prior_->evidence};
    fit.coefficients_mm_.resize(m, 2);
    fit.coefficients_mm_ << joint_.unknowns.segment(kHeadColumns, m), joint_.unknowns.tail(m);
  }
  fit.marks_ = findings_;
  for (std::size_t i = 0; i < used_.size(); ++i) fit.marks_[i].used = used_[i];
  setNoiseRatio(fit);
  setErrorRoots(fit);
  reportParameters(fit);
  return fit;
}

void HeadFitter::setErrorRoots(HeadFit& fit) const {
  const Eigen::MatrixXd& root = joint_.covariance_root;
  const Eigen::Index m = root.rows() - kHeadColumns;
  fit.covariance_root_ = root;
  // Departures are in tolerances: their prior is the unit matrix.
  fit.root_by_tolerances_ = root * root.topRows(kHeadColumns).transpose();
  Eigen::MatrixXd by_prior(root.cols(), root.rows());  // Both priors, in units in which `root` is 1.
  by_prior.leftCols(kHeadColumns) = root.topRows(kHeadColumns).transpose();
  if (m > 0) {
    const Eigen::VectorXd sigmas = sigmasOf(*prior_, *basis_);
    by_prior.rightCols(m) = root.bottomRows(m).transpose() * sigmas.cwiseInverse().asDiagonal();
  }
  fit.root_by_surface_ = root * by_prior.rightCols(m);
  fit.root_by_marks_ = root * semidefiniteRoot(Eigen::MatrixXd::Identity(root.cols(), root.cols()) -
                                               by_prior * by_prior.transpose());
  for (Eigen::MatrixXd* all :
       {&fit.covariance_root_, &fit.root_by_marks_, &fit.root_by_tolerances_, &fit.root_by_surface_}) {
    if (fit.noise_scaled_) *all *= fit.noise_ratio_;
    all->topRows(kHeadColumns) = tolerances_.asDiagonal() * all->topRows(kHeadColumns);
  }
}

void HeadFitter::setNoiseRatio(HeadFit& fit) const {
  if (noise_freedom_ < 1.0) return;  // No parameter left that it could be mixed with.
  fit.noise_ratio_ = std::sqrt(noise_chi2_ / noise_freedom_);
  fit.noise_scaled_ = noise_chi2_ > chiSquareAbove(noise_freedom_, kNoiseScaledAt);
}

void HeadFitter::reportParameters(HeadFit& fit) const {
  const Eigen::MatrixXd root = fit.covariance_root_.topRows(kHeadParameterCount);
  const Eigen::MatrixXd covariance = root * root.transpose();
  const Eigen::VectorXd sigmas = covariance.diagonal().cwiseSqrt();
  for (std::size_t k = 0; k < kHeadParameterCount; ++k) {
    const auto which = static_cast<HeadParameter>(k);
    if (!actsOn(which, design_)) continue;
    const auto row = static_cast<Eigen::Index>(k);
    HeadParameterFinding finding{which, fit.departures_[row], sigmas[row], tolerances_[row], false, {}};
    finding.held = finding.sigma < kHeldShare * finding.prior_sigma;
    double strongest = kMixedCorrelation;
    for (Eigen::Index other = 0; !finding.held && other < covariance.cols(); ++other) {
      const double correlation = std::abs(covariance(row, other)) / (sigmas[row] * sigmas[other]);
      if (other == row || correlation <= strongest) continue;
      strongest = correlation;
      finding.mixed_with = static_cast<HeadParameter>(other);
    }
    fit.parameters_.push_back(finding);
  }
}

}  // namespace kerfbench::calibrate
