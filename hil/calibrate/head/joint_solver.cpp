// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/joint_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace kerfbench::hil {
namespace {

constexpr Eigen::Index kCount = static_cast<Eigen::Index>(kHeadParameterCount);
constexpr double kMoved = 1e-4;  // Of its prior variance: all of them together change the evidence by 0.02.
const double kLeastEvidence = std::log(20.0);
constexpr double kLeastScore =
    3.0;  // Its square over four is about the evidence: below, no surface is tried.

constexpr double kFirstAmplitude_mm = 0.001, kLeastAmplitude_mm = 1e-4, kMostAmplitude_mm = 10.0;

/// Likewise before the marks: a head is its tolerances from the drawing, to this factor (1 sigma).
const double kToleranceSpread = std::log(2.0);

/// Standard deviations of all coefficients before the fit.
Eigen::VectorXd sigmasOf(const SurfacePrior& prior, const SmoothBasis& basis) {
  Eigen::VectorXd sigmas(2 * basis.size());
  for (Eigen::Index k = 0; k < basis.size(); ++k)
    sigmas[k] = sigmas[basis.size() + k] = prior.amplitude_mm * std::pow(prior.decay, basis.order(k).sum());
  return sigmas;
}

Eigen::MatrixXd squareOf(const Eigen::MatrixXd& rows) {
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(rows.cols(), rows.cols());
  square.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
  return square;
}

/// What the marks tell of the surface when the model is left to fit itself: the model's part projected out.
class SurfaceInformation {
 public:
  explicit SurfaceInformation(const JointMarks& marks) : marks_(marks) {
    Eigen::MatrixXd normal = marks.square().topLeftCorner<kCount, kCount>();
    normal.diagonal().array() += 1.0;
    const Eigen::LLT<Eigen::MatrixXd> factor(normal);
    const Eigen::VectorXd scaled = factor.solve(marks.square().row(kCount).head<kCount>().transpose());
    gradient_ = marks.crossed().col(kCount) - marks.crossed().leftCols<kCount>() * scaled;
    crossed_ = factor.matrixL().solve(marks.crossed().leftCols<kCount>().transpose());
  }

  /// Derivative of the evidence by the square of the amplitude at zero, over its own scatter if there is no
  /// surface; correlations of the coefficients are neglected.
  [[nodiscard]] double score(const Eigen::VectorXd& sigmas) const {
    const Eigen::VectorXd expected = marks_.surfaceDiagonal() - crossed_.colwise().squaredNorm().transpose();
    const Eigen::VectorXd weights = sigmas.cwiseAbs2();
    const double excess = weights.dot(gradient_.cwiseAbs2() - expected);
    return excess / std::sqrt(2.0 * weights.cwiseProduct(expected).squaredNorm());
  }

  void complete() { information_ = marks_.surfaceSquare() - squareOf(crossed_); }

  [[nodiscard]] double evidence(const Eigen::VectorXd& sigmas) const {
    // Coefficients that the marks do not move, of high degree mostly, change nothing.
    std::vector<Eigen::Index> moved;
    for (Eigen::Index k = 0; k < sigmas.size(); ++k) {
      if (sigmas[k] * sigmas[k] * information_(k, k) > kMoved) moved.push_back(k);
    }
    const Eigen::VectorXd scale = sigmas(moved);
    Eigen::MatrixXd scaled = scale.asDiagonal() * information_(moved, moved) * scale.asDiagonal();
    scaled.diagonal().array() += 1.0;
    const Eigen::LLT<Eigen::MatrixXd> factor(scaled);
    const Eigen::VectorXd half = factor.matrixL().solve(scale.cwiseProduct(gradient_(moved)));
    const Eigen::VectorXd diagonal = factor.matrixLLT().diagonal();
    return 0.5 * half.squaredNorm() - diagonal.array().log().sum();
  }

 private:
  const JointMarks& marks_;
  Eigen::MatrixXd crossed_, information_;  ///< Of the latter the lower part.
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

JointMarks::JointMarks(std::vector<Eigen::Matrix2d> whitenings_1_mm, RowMatrix basis, Eigen::MatrixXd shared)
    : whitenings_1_mm_(std::move(whitenings_1_mm)), basis_(std::move(basis)), shared_(std::move(shared)) {
  const auto n = static_cast<Eigen::Index>(whitenings_1_mm_.size());
  weight_xx_.resize(n);
  weight_xy_.resize(n);
  weight_yy_.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Matrix2d& w = whitenings_1_mm_[static_cast<std::size_t>(i)];
    weight_xx_[i] = w.col(0).squaredNorm();
    weight_xy_[i] = w.col(0).dot(w.col(1));
    weight_yy_[i] = w.col(1).squaredNorm();
  }
  if (shared_.cols() == 0) return;
  Eigen::MatrixXd normal = shared_.transpose() * shared_;
  normal.diagonal().array() += 1.0;
  shared_normal_.compute(normal);
  shared_basis_ = shared_normal_.matrixL().solve(byFunctions(shared_).transpose());
}

template <typename Rows>
Eigen::MatrixXd JointMarks::byFunctions(const Rows& rows) const {
  Rows x(basis_.rows(), rows.cols()), y(basis_.rows(), rows.cols());
  for (Eigen::Index i = 0; i < basis_.rows(); ++i) {
    const Eigen::Matrix2d& w = whitenings_1_mm_[static_cast<std::size_t>(i)];
    x.row(i) = w(0, 0) * rows.row(2 * i) + w(1, 0) * rows.row(2 * i + 1);
    y.row(i) = w(0, 1) * rows.row(2 * i) + w(1, 1) * rows.row(2 * i + 1);
  }
  Eigen::MatrixXd products(2 * functions(), rows.cols());
  products.topRows(functions()).noalias() = basis_.transpose() * x;
  products.bottomRows(functions()).noalias() = basis_.transpose() * y;
  return products;
}

void JointMarks::linearise(const WhitenedRows& rows) {
  square_ = Eigen::MatrixXd::Zero(kCount + 1, kCount + 1);
  square_.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
  if (functions() > 0) crossed_ = byFunctions(rows);
  if (shared_.cols() == 0) return;
  shared_rows_ = shared_normal_.matrixL().solve(shared_.transpose() * rows);
  square_.selfadjointView<Eigen::Lower>().rankUpdate(shared_rows_.transpose(), -1.0);
  if (functions() > 0) crossed_.noalias() -= shared_basis_.transpose() * shared_rows_;
}

const Eigen::MatrixXd& JointMarks::surfaceSquare() const {
  const Eigen::Index m = functions();
  if (surface_square_.rows() == 2 * m) return surface_square_;
  surface_square_ = Eigen::MatrixXd::Zero(2 * m, 2 * m);
  const auto block = [&](const Eigen::VectorXd& weights) {
    Eigen::MatrixXd square(m, m);
    const RowMatrix weighted = weights.asDiagonal() * basis_;
    square.triangularView<Eigen::Lower>() = basis_.transpose() * weighted;
    return square;
  };
  surface_square_.topLeftCorner(m, m).triangularView<Eigen::Lower>() = block(weight_xx_);
  surface_square_.bottomLeftCorner(m, m) = block(weight_xy_).selfadjointView<Eigen::Lower>();
  surface_square_.bottomRightCorner(m, m).triangularView<Eigen::Lower>() = block(weight_yy_);
  if (shared_.cols() > 0)
    surface_square_.selfadjointView<Eigen::Lower>().rankUpdate(shared_basis_.transpose(), -1.0);
  return surface_square_;
}

Eigen::VectorXd JointMarks::surfaceDiagonal() const {
  Eigen::VectorXd diagonal(2 * functions());
  const RowMatrix squares = basis_.cwiseAbs2();
  diagonal << squares.transpose() * weight_xx_, squares.transpose() * weight_yy_;
  if (shared_.cols() > 0) diagonal -= shared_basis_.colwise().squaredNorm().transpose();
  return diagonal;
}

Eigen::MatrixXd JointMarks::sharedSlopes() const {
  Eigen::MatrixXd slopes(shared_.cols(), kCount + 2 * functions() + 1);
  if (shared_.cols() > 0) slopes << shared_rows_.leftCols<kCount>(), shared_basis_, shared_rows_.col(kCount);
  return slopes;
}

Eigen::MatrixXd JointMarks::sharedReach(const Eigen::MatrixXd& rows) const {
  if (shared_.cols() == 0) return Eigen::MatrixXd(0, rows.rows());
  return shared_normal_.matrixL().solve(rows.transpose());
}

JointSolution solveJoint(const JointMarks& marks, const SmoothBasis& basis,
                         const std::optional<SurfacePrior>& prior, bool with_covariance) {
  const Eigen::Index m = prior ? 2 * marks.functions() : 0;
  Eigen::VectorXd sigmas = Eigen::VectorXd::Ones(kCount + m);
  // In units of the priors the normal matrix is the identity and what the marks add: never singular.
  Eigen::MatrixXd normal(kCount + m, kCount + m);
  Eigen::VectorXd gradient(kCount + m);
  normal.topLeftCorner<kCount, kCount>() = marks.square().topLeftCorner<kCount, kCount>();
  gradient.head<kCount>() = marks.square().row(kCount).head<kCount>().transpose();
  if (prior) {
    sigmas.tail(m) = sigmasOf(*prior, basis);
    const auto surface = sigmas.tail(m).asDiagonal();
    normal.bottomLeftCorner(m, kCount) = surface * marks.crossed().leftCols<kCount>();
    normal.bottomRightCorner(m, m) = surface * marks.surfaceSquare() * surface;
    gradient.tail(m) = surface * marks.crossed().col(kCount);
  }
  normal.diagonal().array() += 1.0;
  const Eigen::LLT<Eigen::MatrixXd> factor(normal);
  JointSolution solution;
  solution.unknowns = sigmas.cwiseProduct(factor.solve(gradient));
  if (!with_covariance) return solution;
  const Eigen::MatrixXd inverse = factor.matrixL().solve(Eigen::MatrixXd::Identity(kCount + m, kCount + m));
  solution.covariance_root = sigmas.asDiagonal() * inverse.transpose();
  return solution;
}

double toleranceFactor(const JointMarks& marks, const SmoothBasis& basis,
                       const std::optional<SurfacePrior>& prior) {
  Eigen::MatrixXd square = marks.square();  // Of the model, what the surface may be projected out.
  if (prior) {
    const Eigen::VectorXd sigmas = sigmasOf(*prior, basis);
    Eigen::MatrixXd normal = sigmas.asDiagonal() * marks.surfaceSquare() * sigmas.asDiagonal();
    normal.diagonal().array() += 1.0;
    const Eigen::LLT<Eigen::MatrixXd> factor(normal);
    const Eigen::MatrixXd taken = factor.matrixL().solve(sigmas.asDiagonal() * marks.crossed());
    square.selfadjointView<Eigen::Lower>().rankUpdate(taken.transpose(), -1.0);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> held(square.topLeftCorner<kCount, kCount>());
  const Eigen::ArrayXd information = held.eigenvalues().array().max(0.0);
  const Eigen::ArrayXd gradient2 =
      (held.eigenvectors().transpose() * square.row(kCount).head<kCount>().transpose()).array().square();
  constexpr int kSteps = 32;       // Each way.
  constexpr double kStep = 0.125;  // Of log2 of the factor.
  std::vector<double> factors2, logs;
  for (int step = -kSteps; step <= kSteps; ++step) {
    const double log2 = kStep * step;
    const double factor2 = std::exp2(2.0 * log2);
    const Eigen::ArrayXd grown = 1.0 + factor2 * information;
    const double before = log2 * std::log(2.0) / kToleranceSpread;
    factors2.push_back(factor2);
    logs.push_back(0.5 * (factor2 * gradient2 / grown - grown.log()).sum() - 0.5 * before * before);
  }
  const double most = *std::ranges::max_element(logs);
  double sum = 0.0, weights = 0.0;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const double weight = std::exp(logs[i] - most);
    weights += weight;
    sum += weight * factors2[i];
  }
  return std::sqrt(sum / weights);
}

std::vector<double> promisingDecays(const JointMarks& marks, const SmoothBasis& basis) {
  const SurfaceInformation information(marks);
  std::vector<double> promising;
  for (const double decay : {0.5, 0.7, 0.85, 1.0}) {
    if (information.score(sigmasOf({1.0, decay, 0.0}, basis)) > kLeastScore) promising.push_back(decay);
  }
  return promising;
}

std::optional<SurfacePrior> bestSurface(const JointMarks& marks, const SmoothBasis& basis,
                                        std::span<const double> decays) {
  SurfaceInformation information(marks);
  information.complete();
  const auto at = [&](double decay, double amplitude_mm) {
    SurfacePrior prior{amplitude_mm, decay, 0.0};
    prior.evidence = information.evidence(sigmasOf(prior, basis));
    return prior;
  };
  SurfacePrior best{kFirstAmplitude_mm, 0.0, -INFINITY};
  for (const double decay : decays) {
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
