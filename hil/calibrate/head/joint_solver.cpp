// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/joint_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>

#include "hil/calibrate/head/head_parameters.h"

namespace kerfbench::calibrate {
namespace {

/// Before the marks: a head is its tolerances from the drawing, to this factor (1 sigma).
const double kToleranceSpread = std::log(2.0);

/// Inverse of a lower triangular matrix: a third of the work of solving for all columns.
Eigen::MatrixXd inverseOf(const Eigen::MatrixXd& lower) {
  constexpr Eigen::Index kColumns = 32;
  const Eigen::Index n = lower.rows();
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index first = 0; first < n; first += kColumns) {
    const Eigen::Index rest = n - first, columns = std::min(kColumns, rest);
    auto block = inverse.block(first, first, rest, columns);
    block.diagonal().setOnes();
    lower.bottomRightCorner(rest, rest).triangularView<Eigen::Lower>().solveInPlace(block);
  }
  return inverse;
}

}  // namespace

Eigen::Matrix2Xd rowsOf(const HeadJacobian& by_scaled, const Eigen::VectorXd& basis) {
  const Eigen::Index m = basis.size();
  Eigen::Matrix2Xd rows = Eigen::Matrix2Xd::Zero(2, kHeadColumns + 2 * m);
  rows.leftCols(kHeadColumns) = by_scaled;
  rows.block(0, kHeadColumns, 1, m) = basis.transpose();
  rows.block(1, kHeadColumns + m, 1, m) = basis.transpose();
  return rows;
}

Eigen::VectorXd sigmasOf(const SurfacePrior& prior, const SmoothBasis& basis) {
  Eigen::VectorXd sigmas(2 * basis.size());
  for (Eigen::Index k = 0; k < basis.size(); ++k)
    sigmas[k] = sigmas[basis.size() + k] = prior.amplitude_mm * std::pow(prior.decay, basis.order(k).sum());
  return sigmas;
}

double ModelInformation::misfit(const HeadVector& step) const {
  Eigen::Matrix<double, kHeadColumns + 1, 1> left;
  left << -step, 1.0;
  return left.dot(square_.selfadjointView<Eigen::Lower>() * left) + (home_ - step).squaredNorm();
}

HeadVector ModelInformation::step(double damping) const {
  return factor(damping).solve(square_.row(kHeadColumns).head<kHeadColumns>().transpose() + home_);
}

Eigen::LLT<ModelInformation::Normal> ModelInformation::factor(double damping) const {
  Normal normal = square_.topLeftCorner<kHeadColumns, kHeadColumns>();
  normal.diagonal().array() += 1.0 + damping;
  return normal.llt();
}

ModelInformation::Normal ModelInformation::covarianceRoot() const {
  return factor(0.0).matrixL().solve(Normal::Identity()).transpose();
}

JointSolver::JointSolver(const JointMarks& marks, Eigen::VectorXd surface_sigmas_mm)
    : marks_(marks), sigmas_mm_(std::move(surface_sigmas_mm)) {
  if (sigmas_mm_.size() == 0) return;
  // In units of the priors the normal matrix is the identity and what the marks add: never singular.
  Eigen::MatrixXd normal = sigmas_mm_.asDiagonal() * marks.surfaceSquare() * sigmas_mm_.asDiagonal();
  normal.diagonal().array() += 1.0;
  surface_.compute(normal);
}

Eigen::MatrixXd JointSolver::taken() const {
  if (sigmas_mm_.size() == 0) return Eigen::MatrixXd(0, kHeadColumns + 1);
  return surface_.matrixL().solve(sigmas_mm_.asDiagonal() * marks_.crossed());
}

ModelInformation JointSolver::left(const Eigen::MatrixXd& taken) const {
  ModelInformation::Square square = marks_.square();
  square.selfadjointView<Eigen::Lower>().rankUpdate(taken.transpose(), -1.0);
  return {square, marks_.home()};
}

JointSolution JointSolver::solve() const {
  const Eigen::Index m = sigmas_mm_.size();
  const Eigen::MatrixXd taken = this->taken();
  const ModelInformation information = left(taken);
  JointSolution solution;
  solution.unknowns.resize(kHeadColumns + m);
  solution.unknowns.head<kHeadColumns>() = information.step();
  solution.covariance_root = Eigen::MatrixXd::Zero(kHeadColumns + m, kHeadColumns + m);
  solution.covariance_root.topLeftCorner<kHeadColumns, kHeadColumns>() = information.covarianceRoot();
  if (m == 0) return solution;
  // What the coefficients are for given departures, and what these make of them.
  const Eigen::MatrixXd surface_root = sigmas_mm_.asDiagonal() * inverseOf(surface_.matrixLLT()).transpose();
  const Eigen::MatrixXd by_model = surface_root.triangularView<Eigen::Upper>() * taken;
  solution.unknowns.tail(m) =
      by_model.col(kHeadColumns) - by_model.leftCols<kHeadColumns>() * solution.unknowns.head<kHeadColumns>();
  solution.covariance_root.bottomLeftCorner(m, kHeadColumns) =
      -by_model.leftCols<kHeadColumns>() *
      solution.covariance_root.topLeftCorner<kHeadColumns, kHeadColumns>();
  solution.covariance_root.bottomRightCorner(m, m) = surface_root;
  return solution;
}

double toleranceFactor(const ModelInformation& model) {
  const ModelInformation::Normal square =
      model.square().topLeftCorner<kHeadColumns, kHeadColumns>().selfadjointView<Eigen::Lower>();
  const Eigen::SelfAdjointEigenSolver<ModelInformation::Normal> held(square);
  // As read from the drawing.
  const HeadVector gradient =
      model.square().row(kHeadColumns).head<kHeadColumns>().transpose() - square * model.home();
  const Eigen::ArrayXd information = held.eigenvalues().array().max(0.0);
  const Eigen::ArrayXd gradient2 = (held.eigenvectors().transpose() * gradient).array().square();
  constexpr int kSteps = 32;       // Each way.
  constexpr double kStep = 0.125;  // Step in log2 of the factor.
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

}  // namespace kerfbench::calibrate
