// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <Eigen/Core>

namespace kerfbench::base {

/// Residuals r(x) to be made small, each in units of its standard deviation.
///
/// The first `robust_blocks` blocks of `block_rows` residuals each count by Cauchy's loss of scale a: a block
/// of squared length s costs a² ln(1 + s / a²) instead of s, so that a false measurement pulls the less the
/// farther it is off. All other residuals cost their squares.
struct LeastSquaresProblem {
  Eigen::Index parameters{};     ///< Number of parameters; > 0.
  Eigen::Index residuals{};      ///< Number of residuals; > 0.
  Eigen::Index robust_blocks{};  ///< >= 0.
  Eigen::Index block_rows{1};    ///< >= 1; robust_blocks * block_rows <= residuals.
  double loss_scale{};           ///< a; > 0 where robust_blocks > 0.

  /// Fills r(x) and, unless `jacobian` is null, dr/dx. Both come with their sizes set; what they hold is left
  /// over. Returns false where the model has no value: a step that leads there is refused.
  std::function<bool(const Eigen::VectorXd& x, Eigen::VectorXd& residuals, Eigen::MatrixXd* jacobian)>
      evaluate;
};

struct LeastSquaresOptions {
  int most_iterations{50};   ///< Steps that are tried, refused ones included; >= 0.
  double start_radius{1e4};  ///< Trust region at the start; > 0. Damping is its inverse.
  double function_tolerance{
      1e-6};  ///< Settled where a step changes the cost by no more than this share; >= 0.
  double gradient_tolerance{1e-10};  ///< Settled where no component of the cost's gradient is larger; >= 0.
  double parameter_tolerance{1e-8};  ///< Settled where a step is no longer than this share of x; >= 0.
};

enum class LeastSquaresEnd {
  kSettled,  ///< One of the tolerances is met.
  kLimit,    ///< The last iteration is used up; x is the best place so far.
  kFailed,   ///< The start, or every step from a place, has no value; x is the start.
};

struct LeastSquaresSummary {
  Eigen::VectorXd x;
  LeastSquaresEnd end{LeastSquaresEnd::kFailed};
  int iterations{};     ///< Steps that were tried.
  int accepted{};       ///< Steps among them that were taken.
  double first_cost{};  ///< Half the sum of squares, or of the losses, at the start.
  double cost{};        ///< Half the sum of squares, or of the losses, at x.

  [[nodiscard]] bool settled() const { return end == LeastSquaresEnd::kSettled; }
};

/// Dense non-linear least squares by the algorithm of Levenberg and Marquardt, for some dozens of parameters.
///
/// With r the residuals, J their Jacobian and D² the diagonal of JᵀJ (kept in 1e-6 … 1e32), a step d solves
///
///     (JᵀJ + D² / radius) d = -Jᵀr
///
/// by Cholesky. It is taken if it gains more than a thousandth of what the linear model promises; rho is the
/// gain over the promise. Then the radius is divided by max(1/3, 1 - (2 rho - 1)³), otherwise by 2, 4, 8 …
/// (Nielsen, "Damping parameter in Marquardt's method", IMM-REP-1999-05). Columns are scaled by 1 / (1 +
/// their length at the start). Robust blocks enter r and J multiplied by the root of the loss's derivative
/// (Triggs et al., "Bundle adjustment", 2000, section 4.3, of which Cauchy's loss needs the first-order part
/// alone).
///
/// The step whose change of the cost is too small to go on is not taken: x is where the tolerance was met.
/// Deterministic: one thread, sums in the order of the residuals.
/// @throws std::invalid_argument if the problem's numbers, or start's size, are out of range.
LeastSquaresSummary minimise(const LeastSquaresProblem& problem, const Eigen::VectorXd& start,
                             const LeastSquaresOptions& options = {});

}  // namespace kerfbench::base
