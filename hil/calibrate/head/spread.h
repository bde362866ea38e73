// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/LU>

namespace kerfbench::calibrate {

/// Finite, symmetric and positive definite.
inline bool isCovariance(const Eigen::Matrix2d& c) {
  return c.allFinite() && std::abs(c(0, 1) - c(1, 0)) <= 1e-9 * (c(0, 0) + c(1, 1)) && c(0, 0) > 0.0 &&
         c.determinant() > 0.0;
}

/// Square of a distance in standard deviations (Mahalanobis).
inline double distance2(const Eigen::Vector2d& d, const Eigen::Matrix2d& covariance) {
  return d.dot(covariance.inverse() * d);
}

/// Value that chi-square of two degrees of freedom exceeds with this chance.
inline double chiSquare2Above(double chance) { return -2.0 * std::log(chance); }

/// Share of places beyond the ellipse that is stated to hold 95 % of them.
inline constexpr double kBeyondEllipse = 0.05;
/// 1 % of a normal variable lie beyond.
inline constexpr double kChanceAsNormal = 2.326;

/// Median of chi-square of two degrees of freedom.
inline constexpr double kMedianChiSquare2 = 1.3862943611198906;

/// Value that chi-square of `freedom` degrees exceeds with the chance that a normal variable exceeds `normal`
/// (Wilson & Hilferty 1931); freedom >= 1.
inline double chiSquareAbove(double freedom, double normal) {
  const double ninth = 2.0 / (9.0 * freedom);
  return freedom * std::pow(1.0 - ninth + normal * std::sqrt(ninth), 3);
}

}  // namespace kerfbench::calibrate
