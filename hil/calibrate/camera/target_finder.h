// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/calibrate/files/target.h"
#include "twin/base/image_fwd.h"

namespace kerfbench::calibrate {

/// One inner corner of the target where a picture shows it.
struct TargetCorner {
  int column{},
      row{};  ///< Row of the square below and right of it, both >= 1: it is at square_mm * (column, row).
  Eigen::Vector2d pixel{Eigen::Vector2d::Zero()};
  Eigen::Matrix2d covariance_px2{Eigen::Matrix2d::Identity()};  ///< Covariance by the picture's noise.
};

/// Target as one picture shows it.
struct TargetView {
  std::vector<TargetCorner> corners;  ///< Row by row.
  int markers{};                      ///< Found.
  double blur_px{};                   ///< Median over the corners.
  double contrast{};                  ///< Median, grey levels.
  std::string fault;                  ///< Reason why the view cannot be used; empty: it can.
};

/// Finds the target's markers, and by them every corner next to a marker; each corner is fitted (see
/// fitCorner) in a window as large as its squares allow. A view with fewer than kLeastCorners has a fault.
/// Safe from several threads.
inline constexpr int kLeastCorners = 12;
TargetView findTarget(const GrayImage& image, const CalibrationTarget& target);

}  // namespace kerfbench::calibrate
