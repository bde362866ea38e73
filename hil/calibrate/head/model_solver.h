// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "hil/calibrate/head/head_parameters.h"
#include "hil/calibrate/head/nominal_head.h"

namespace kerfbench::calibrate {

/// A mark ready for fitting.
struct WeighedMark {
  Eigen::Vector2d angles_rad{Eigen::Vector2d::Zero()};  ///< Angles of the mirrors as wired.
  Eigen::Vector2d measured_W_mm{Eigen::Vector2d::Zero()};
  /// Turns a residual in mm into independent ones of variance 1.
  Eigen::Matrix2d whitening_1_mm{Eigen::Matrix2d::Identity()};
};

using HeadJacobian = Eigen::Matrix<double, 2, static_cast<int>(kHeadParameterCount)>;

/// Places of the marks by the model; `scaled`: departures over their tolerances.
std::vector<std::optional<Eigen::Vector2d>> landings(const HeadDesign& design, const HeadVector& tolerances,
                                                     const HeadVector& scaled,
                                                     std::span<const WeighedMark> marks);

/// Distance of each mark from where the model has it, in standard deviations; infinite where it does not
/// land.
std::vector<double> distancesFrom(const HeadDesign& design, const HeadVector& tolerances,
                                  const HeadVector& scaled, std::span<const WeighedMark> marks);

/// Mark by the model at some departures.
struct ModelledMark {
  bool lands{};
  Eigen::Vector2d p_W_mm{Eigen::Vector2d::Zero()};
  HeadJacobian by_scaled;  ///< mm per tolerance.
};

/// `scaled`: departures over their tolerances.
std::vector<ModelledMark> modelled(const HeadDesign& design, const HeadVector& tolerances,
                                   const HeadVector& scaled, std::span<const WeighedMark> marks);

struct ModelSolution {
  HeadVector scaled{HeadVector::Zero()};
  bool converged{};
};

/// Least squares over marks and tolerances from `start`, by the algorithm of Levenberg and Marquardt.
/// `loss_scale`: of Cauchy's loss, in standard deviations of a mark; 0: none.
ModelSolution solveModel(const HeadDesign& design, const HeadVector& tolerances, const HeadVector& start,
                         std::span<const WeighedMark> marks, double loss_scale, int most_iterations);

}  // namespace kerfbench::calibrate
