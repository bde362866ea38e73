// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/joint_solver.h"

#include <cmath>

#include <Eigen/Cholesky>

namespace kerfbench::hil {
namespace {

constexpr Eigen::Index kCount = static_cast<Eigen::Index>(kHeadParameterCount);
const double kLeastEvidence = std::log(20.0);
constexpr double kLeastScore =
    3.0;  // Its square over four is about the evidence: below, no surface is tried.

constexpr double kFirstAmplitude_mm = 0.005, kLeastAmplitude_mm = 1e-4, kMostAmplitude_mm = 10.0;

Eigen::MatrixXd whitenedDepartures(const std::vector<LinearMark>& marks) {
  Eigen::MatrixXd rows(2 * static_cast<Eigen::Index>(marks.size()), kCount);
  for (std::size_t i = 0; i < marks.size(); ++i)
    rows.middleRows<2>(2 * static_cast<Eigen::Index>(i)) = marks[i].whitening_1_mm * marks[i].by_scaled;
  return rows;
}

Eigen::MatrixXd whitenedBasis(const std::vector<LinearMark>& marks) {
  const Eigen::Index m = marks.front().basis.size();
  Eigen::MatrixXd rows(2 * static_cast<Eigen::Index>(marks.size()), 2 * m);
  for (std::size_t i = 0; i < marks.size(); ++i) {
    auto two = rows.middleRows<2>(2 * static_cast<Eigen::Index>(i));
    two.leftCols(m) = marks[i].whitening_1_mm.col(0) * marks[i].basis.transpose();
    two.rightCols(m) = marks[i].whitening_1_mm.col(1) * marks[i].basis.transpose();
  }
  return rows;
}

Eigen::VectorXd whitenedReadings(const std::vector<LinearMark>& marks) {
  Eigen::VectorXd readings(2 * static_cast<Eigen::Index>(marks.size()));
  for (std::size_t i = 0; i < marks.size(); ++i)
    readings.segment<2>(2 * static_cast<Eigen::Index>(i)) = marks[i].whitening_1_mm * marks[i].reading_mm;
  return readings;
}

Eigen::MatrixXd squareOf(const Eigen::MatrixXd& rows) {
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(rows.cols(), rows.cols());
  square.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
  return square.selfadjointView<Eigen::Lower>();
}

/// Standard deviations of all coefficients before the fit.
Eigen::VectorXd sigmasOf(const SurfacePrior& prior, const SmoothBasis& basis) {
  Eigen::VectorXd sigmas(2 * basis.size());
  for (Eigen::Index k = 0; k < basis.size(); ++k)
    sigmas[k] = sigmas[basis.size() + k] = prior.amplitude_mm * std::pow(prior.decay, basis.order(k).sum());
  return sigmas;
}

/// What the marks tell of the surface when the model is left to fit itself: the model's part projected out.
class SurfaceInformation {
 public:
  explicit SurfaceInformation(const std::vector<LinearMark>& marks)
      : basis_rows_(whitenedBasis(marks)), model_(whitenedDepartures(marks)) {
    const Eigen::MatrixXd normal = squareOf(model_) + Eigen::MatrixXd::Identity(kCount, kCount);
    const Eigen::LLT<Eigen::MatrixXd> factor(normal);
    const Eigen::VectorXd readings = whitenedReadings(marks);
    const Eigen::VectorXd scaled = factor.solve(model_.transpose() * readings);
    gradient_ = basis_rows_.transpose() * (readings - model_ * scaled);
    crossed_ = factor.matrixL().solve(model_.transpose() * basis_rows_);
  }

  /// Derivative of the evidence by the square of the amplitude at zero, over its own scatter if there is no
  /// surface; correlations of the coefficients are neglected.
  [[nodiscard]] double score(const Eigen::VectorXd& sigmas) const {
    const Eigen::VectorXd expected =
        (basis_rows_.colwise().squaredNorm() - crossed_.colwise().squaredNorm()).transpose();
    const Eigen::VectorXd weights = sigmas.cwiseAbs2();
    const double excess = weights.dot(gradient_.cwiseAbs2() - expected);
    return excess / std::sqrt(2.0 * weights.cwiseProduct(expected).squaredNorm());
  }

  void complete() { information_ = squareOf(basis_rows_) - squareOf(crossed_); }

  [[nodiscard]] double evidence(const Eigen::VectorXd& sigmas) const {
    Eigen::MatrixXd scaled = sigmas.asDiagonal() * information_ * sigmas.asDiagonal();
    scaled.diagonal().array() += 1.0;
    const Eigen::LLT<Eigen::MatrixXd> factor(scaled);
    const Eigen::VectorXd half = factor.matrixL().solve(sigmas.cwiseProduct(gradient_));
    const Eigen::VectorXd diagonal = factor.matrixLLT().diagonal();
    return 0.5 * half.squaredNorm() - diagonal.array().log().sum();
  }

 private:
  Eigen::MatrixXd basis_rows_, model_, crossed_, information_;
  Eigen::VectorXd gradient_;
};

}  // namespace

Eigen::Matrix2Xd rowsOf(const HeadJacobian& by_scaled, const Eigen::VectorXd& basis) {
  const Eigen::Index m = basis.size();
  Eigen::Matrix2Xd rows = Eigen::Matrix2Xd::Zero(2, kCount + 2 * m);
  rows.leftCols(kCount) = by_scaled;
  rows.block(0, kCount, 1, m) = basis.transpose();
  rows.block(1, kCount + m, 1, m) = basis.transpose();
  return rows;
}

JointSolution solveJoint(const std::vector<LinearMark>& marks, const SmoothBasis& basis,
                         const std::optional<SurfacePrior>& prior, bool with_covariance) {
  const Eigen::Index m = prior ? 2 * basis.size() : 0;
  Eigen::VectorXd sigmas = Eigen::VectorXd::Ones(kCount + m);
  Eigen::MatrixXd rows(2 * static_cast<Eigen::Index>(marks.size()), kCount + m);
  rows.leftCols(kCount) = whitenedDepartures(marks);
  if (prior) {
    sigmas.tail(m) = sigmasOf(*prior, basis);
    rows.rightCols(m) = whitenedBasis(marks) * sigmas.tail(m).asDiagonal();
  }
  // In units of the priors the normal matrix is the identity and what the marks add: never singular.
  Eigen::MatrixXd normal = squareOf(rows);
  normal.diagonal().array() += 1.0;
  const Eigen::LLT<Eigen::MatrixXd> factor(normal);
  JointSolution solution;
  solution.unknowns = sigmas.cwiseProduct(factor.solve(rows.transpose() * whitenedReadings(marks)));
  if (!with_covariance) return solution;
  const Eigen::MatrixXd inverse = factor.matrixL().solve(Eigen::MatrixXd::Identity(kCount + m, kCount + m));
  solution.covariance_root = sigmas.asDiagonal() * inverse.transpose();
  return solution;
}

std::optional<SurfacePrior> bestSurface(const std::vector<LinearMark>& marks, const SmoothBasis& basis) {
  constexpr double kDecays[] = {0.5, 0.7, 0.85, 1.0};
  SurfaceInformation information(marks);
  bool promising = false;
  for (const double decay : kDecays)
    promising = promising || information.score(sigmasOf({1.0, decay, 0.0}, basis)) > kLeastScore;
  if (!promising) return std::nullopt;
  information.complete();
  const auto at = [&](double decay, double amplitude_mm) {
    SurfacePrior prior{amplitude_mm, decay, 0.0};
    prior.evidence = information.evidence(sigmasOf(prior, basis));
    return prior;
  };
  SurfacePrior best{kFirstAmplitude_mm, kDecays[0], -INFINITY};
  for (const double decay : kDecays) {
    // Up the slope by factors of two, from where the last decay had its best: there is one top.
    SurfacePrior here = at(decay, best.amplitude_mm);
    for (const double factor : {2.0, 0.5}) {
      for (SurfacePrior next = at(decay, factor * here.amplitude_mm);
           next.evidence > here.evidence && next.amplitude_mm > kLeastAmplitude_mm &&
           next.amplitude_mm < kMostAmplitude_mm;
           next = at(decay, factor * here.amplitude_mm))
        here = next;
    }
    if (here.evidence > best.evidence) best = here;
  }
  if (best.evidence < kLeastEvidence) return std::nullopt;
  return best;
}

}  // namespace kerfbench::hil
