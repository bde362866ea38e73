// SPDX-License-Identifier: Apache-2.0
#include "hil/base/least_squares.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Cholesky>

namespace kerfbench::base {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNoValue = std::numeric_limits<double>::max();
constexpr double kLeastDiagonal = 1e-6, kMostDiagonal = 1e32;
constexpr double kLeastRadius = 1e-32, kMostRadius = 1e16;
constexpr double kLeastGain = 1e-3;  // Share of the promise that a step must keep.
constexpr int kMostInvalid = 5;      // Steps in a row that the linear system does not give.

void check(const LeastSquaresProblem& problem, const VectorXd& start) {
  if (problem.parameters <= 0 || problem.residuals <= 0 || !problem.evaluate)
    throw std::invalid_argument("least squares: a problem without parameters, residuals or a model");
  if (problem.robust_blocks < 0 || problem.block_rows < 1 ||
      problem.robust_blocks > problem.residuals / problem.block_rows)
    throw std::invalid_argument("least squares: more robust blocks than residuals");
  if (problem.robust_blocks > 0 && !(problem.loss_scale > 0.0))
    throw std::invalid_argument("least squares: the scale of the loss must be > 0");
  if (start.size() != problem.parameters)
    throw std::invalid_argument("least squares: the start has another number of parameters");
}

/// Half the cost's sum; residuals, and the Jacobian's rows if it is not null, become those of the weighted
/// problem.
double weigh(const LeastSquaresProblem& problem, VectorXd& residuals, MatrixXd* jacobian) {
  const double scale2 = problem.loss_scale * problem.loss_scale;
  double cost = 0.0;
  for (Index i = 0; i < problem.robust_blocks; ++i) {
    const Index row = i * problem.block_rows;
    const double square = residuals.segment(row, problem.block_rows).squaredNorm();
    const double sum = 1.0 + square * (1.0 / scale2);
    cost += 0.5 * (scale2 * std::log(sum));
    const double root = std::sqrt(std::max(std::numeric_limits<double>::min(), 1.0 / sum));
    residuals.segment(row, problem.block_rows) *= root;
    if (jacobian != nullptr) jacobian->middleRows(row, problem.block_rows) *= root;
  }
  const Index plain = problem.robust_blocks * problem.block_rows;
  return cost + 0.5 * residuals.tail(problem.residuals - plain).squaredNorm();
}

/// The trust region's radius.
class Radius {
 public:
  explicit Radius(double start) : radius_(start) {}
  [[nodiscard]] double value() const { return radius_; }
  void accept(double gain) {
    radius_ = std::min(kMostRadius, radius_ / std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * gain - 1.0, 3)));
    shrink_ = 2.0;
  }
  void refuse() {
    radius_ /= shrink_;
    shrink_ *= 2.0;
  }

 private:
  double radius_, shrink_{2.0};
};

class Minimiser {
 public:
  Minimiser(const LeastSquaresProblem& problem, const VectorXd& start, const LeastSquaresOptions& options)
      : problem_(problem),
        options_(options),
        radius_(options.start_radius),
        x_(start),
        residuals_(problem.residuals),
        jacobian_(problem.residuals, problem.parameters) {}

  LeastSquaresSummary run();

 private:
  /// False where the model has no value at x.
  bool linearise();
  /// Half the cost's sum at a place.
  double costAt(const VectorXd& x);
  /// False where the damped system gives no step that promises to gain.
  bool computeStep();
  LeastSquaresEnd iterate(LeastSquaresSummary& summary);

  const LeastSquaresProblem& problem_;
  const LeastSquaresOptions& options_;
  Radius radius_;
  VectorXd x_;
  VectorXd residuals_;  ///< Weighted, at x.
  MatrixXd jacobian_;   ///< Weighted, its columns scaled.
  VectorXd scale_;
  VectorXd diagonal_;  ///< D².
  double cost_{}, steepest_{};
  VectorXd step_;  ///< In scaled parameters.
  double promise_{};
};

bool Minimiser::linearise() {
  if (!problem_.evaluate(x_, residuals_, &jacobian_)) return false;
  cost_ = weigh(problem_, residuals_, &jacobian_);
  if (!std::isfinite(cost_) || !jacobian_.allFinite()) return false;
  steepest_ = (jacobian_.transpose() * residuals_).lpNorm<Eigen::Infinity>();
  if (scale_.size() == 0) scale_ = (1.0 + jacobian_.colwise().squaredNorm().array().sqrt()).inverse();
  jacobian_ *= scale_.asDiagonal();
  diagonal_ = jacobian_.colwise().squaredNorm().cwiseMax(kLeastDiagonal).cwiseMin(kMostDiagonal);
  return true;
}

double Minimiser::costAt(const VectorXd& x) {
  VectorXd residuals(problem_.residuals);
  if (!problem_.evaluate(x, residuals, nullptr)) return kNoValue;
  const double cost = weigh(problem_, residuals, nullptr);
  return std::isfinite(cost) ? cost : kNoValue;
}

bool Minimiser::computeStep() {
  MatrixXd normal = MatrixXd::Zero(problem_.parameters, problem_.parameters);
  normal.selfadjointView<Eigen::Upper>().rankUpdate(jacobian_.transpose());
  normal.diagonal() += diagonal_ / radius_.value();
  const Eigen::LLT<MatrixXd, Eigen::Upper> factor(normal);
  if (factor.info() != Eigen::Success) return false;
  step_ = -factor.solve(jacobian_.transpose() * residuals_);
  if (!step_.allFinite()) return false;
  const VectorXd change = jacobian_ * step_;
  promise_ = -change.dot(residuals_ + change / 2.0);
  return promise_ > 0.0;
}

LeastSquaresEnd Minimiser::iterate(LeastSquaresSummary& summary) {
  bool moved = true;
  int invalid = 0;
  while (true) {
    if (summary.iterations >= options_.most_iterations) return LeastSquaresEnd::kLimit;
    if (moved && steepest_ <= options_.gradient_tolerance) return LeastSquaresEnd::kSettled;
    if (radius_.value() < kLeastRadius) return LeastSquaresEnd::kSettled;
    ++summary.iterations;
    moved = false;
    if (!computeStep()) {
      if (++invalid >= kMostInvalid) return LeastSquaresEnd::kFailed;
      radius_.refuse();
      continue;
    }
    invalid = 0;
    const VectorXd next = x_ + step_.cwiseProduct(scale_);
    const double next_cost = costAt(next);
    const double gained = cost_ - next_cost;
    const double tolerance = options_.parameter_tolerance;
    if ((x_ - next).norm() <= tolerance * (x_.norm() + tolerance)) return LeastSquaresEnd::kSettled;
    if (std::abs(gained) <= options_.function_tolerance * cost_) return LeastSquaresEnd::kSettled;
    if (next_cost < kNoValue && gained > kLeastGain * promise_) {
      const double gain = gained / promise_;
      x_ = next;
      if (!linearise()) return LeastSquaresEnd::kFailed;
      radius_.accept(gain);
      moved = true;
      ++summary.accepted;
      continue;
    }
    radius_.refuse();
  }
}

LeastSquaresSummary Minimiser::run() {
  LeastSquaresSummary summary;
  const VectorXd start = x_;
  summary.x = start;
  if (!linearise()) {
    summary.first_cost = summary.cost = kNoValue;
    return summary;
  }
  summary.first_cost = cost_;
  summary.end = iterate(summary);
  const bool failed = summary.end == LeastSquaresEnd::kFailed;
  summary.x = failed ? start : x_;
  summary.cost = failed ? summary.first_cost : cost_;
  return summary;
}

}  // namespace

LeastSquaresSummary minimise(const LeastSquaresProblem& problem, const VectorXd& start,
                             const LeastSquaresOptions& options) {
  check(problem, start);
  return Minimiser(problem, start, options).run();
}

}  // namespace kerfbench::base
