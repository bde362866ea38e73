// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "hil/calibrate/head/model_solver.h"
#include "hil/calibrate/head/residual_surface.h"

namespace kerfbench::hil {

/// Before it is fitted, a coefficient of degree k of the residual surface is zero ± amplitude · decay^k.
struct SurfacePrior {
  double amplitude_mm{};
  double decay{};
  double evidence{};  ///< Logarithm of the odds against no surface.
};

/// A mark, linearised: measured = J · scaled departures + surface + noise.
struct LinearMark {
  HeadJacobian by_scaled;
  Eigen::VectorXd basis;                                ///< Of the surface; empty without.
  Eigen::Vector2d reading_mm{Eigen::Vector2d::Zero()};  ///< Measured - modelled + J · scaled there.
  Eigen::Matrix2d whitening_1_mm{Eigen::Matrix2d::Identity()};
};

/// Model and surface as one linear problem with Gaussian priors: departures 0 ± tolerance, coefficients as
/// SurfacePrior. Unknowns are the scaled departures, the surface's coefficients for x, then for y.
struct JointSolution {
  Eigen::VectorXd unknowns;
  Eigen::MatrixXd covariance_root;  ///< Upper triangular L with L L^T = covariance; empty if not asked for.
};

JointSolution solveJoint(const std::vector<LinearMark>& marks, const SmoothBasis& basis,
                         const std::optional<SurfacePrior>& prior, bool with_covariance);

/// The prior with the largest marginal likelihood, of decays of 0.5 … 1 and amplitudes of 0.1 µm … 10 mm;
/// nullopt where even that one has odds below 20 : 1 against no surface.
std::optional<SurfacePrior> bestSurface(const std::vector<LinearMark>& marks, const SmoothBasis& basis);

/// Rows of d(x, y)/d(unknowns) of a mark; only of the departures without a surface.
Eigen::Matrix2Xd rowsOf(const HeadJacobian& by_scaled, const Eigen::VectorXd& basis);

}  // namespace kerfbench::hil
