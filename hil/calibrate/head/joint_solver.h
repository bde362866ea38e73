// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "hil/calibrate/head/joint_marks.h"
#include "hil/calibrate/head/model_solver.h"
#include "hil/calibrate/head/residual_surface.h"

namespace kerfbench::calibrate {

/// Prior of the residual surface: a coefficient of degree k is zero ± amplitude · decay^k.
struct SurfacePrior {
  double amplitude_mm{};
  double decay{};
  double evidence{};  ///< Logarithm of the odds against no surface.
};

/// Standard deviations of all coefficients before the fit, for x, then for y.
Eigen::VectorXd sigmasOf(const SurfacePrior& prior, const SmoothBasis& basis);

/// Information of marks and tolerances on a step of the model's scaled departures, where for any step the
/// surface and the sheets' shared errors are as they fit best.
class ModelInformation {
 public:
  static constexpr int kCount = static_cast<int>(kHeadParameterCount);
  using Normal = Eigen::Matrix<double, kCount, kCount>;
  using Square = Eigen::Matrix<double, kCount + 1, kCount + 1>;

  /// `square`: of the marks' rows, its lower part. `home`: the step that leads to the drawing, ± 1 before.
  ModelInformation(const Square& square, HeadVector home) : square_(square), home_(std::move(home)) {}
  [[nodiscard]] const Square& square() const { return square_; }
  [[nodiscard]] const HeadVector& home() const { return home_; }

  /// Sum of squares that a step leaves of marks and tolerances.
  [[nodiscard]] double misfit(const HeadVector& step) const;
  /// The step that leaves least, if there is `damping` times as much to say for none as for the drawing.
  [[nodiscard]] HeadVector step(double damping = 0.0) const;
  /// Upper triangular L with L L^T = covariance of the scaled departures.
  [[nodiscard]] Normal covarianceRoot() const;

 private:
  [[nodiscard]] Eigen::LLT<Normal> factor(double damping) const;

  Square square_;
  HeadVector home_;
};

/// Unknowns are the step of the scaled departures, the surface's coefficients for x, then for y.
struct JointSolution {
  Eigen::VectorXd unknowns;
  /// L with L L^T = covariance: departures are moved by its first columns only, as many as they are, and both
  /// blocks of the diagonal are upper triangular.
  Eigen::MatrixXd covariance_root;
};

/// Model and surface as one linear problem with Gaussian priors: departures 0 ± tolerance, coefficients as
/// they are said to be. The surface's part is factored once for all linearisations of the marks.
class JointSolver {
 public:
  /// `marks` must outlive it. `surface_sigmas_mm`: sigmasOf(), empty without a surface.
  JointSolver(const JointMarks& marks, Eigen::VectorXd surface_sigmas_mm);

  /// Information on the model that the marks hold, as linearised now.
  [[nodiscard]] ModelInformation model() const { return left(taken()); }
  [[nodiscard]] JointSolution solve() const;

 private:
  /// Part of departures and reading that the surface takes, in units in which it is independent of variance
  /// 1.
  [[nodiscard]] Eigen::MatrixXd taken() const;
  [[nodiscard]] ModelInformation left(const Eigen::MatrixXd& taken) const;

  const JointMarks& marks_;
  Eigen::VectorXd sigmas_mm_;
  Eigen::LLT<Eigen::MatrixXd> surface_;
};

/// Distance of this head from its drawing, in tolerances, by what the marks hold of it: the root of the mean
/// square that one factor to all tolerances has, given the marks (marginal likelihood; before them it is 1,
/// to a factor of 2 either way, log-normal). What the marks cannot tell is then no better and no worse than
/// the rest.
double toleranceFactor(const ModelInformation& model);

/// Rows of d(x, y)/d(unknowns) of a mark; only of the departures without a surface.
Eigen::Matrix2Xd rowsOf(const HeadJacobian& by_scaled, const Eigen::VectorXd& basis);

}  // namespace kerfbench::calibrate
