// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "hil/calibrate/marks/mark_strokes.h"
#include "hil/dieline/geometry.h"
#include "hil/vision/kerf/kerf_measurement.h"
#include "hil/vision/marks/constellation.h"

namespace kerfbench::calibrate {

/// The line through two opposite arms as first seen, in S.
struct ArmLine {
  Eigen::Vector2d p_mm{Eigen::Vector2d::Zero()};  ///< Point between the arms.
  Eigen::Vector2d along{Eigen::Vector2d::UnitX()};
  std::array<double, 4> ends_mm{};  ///< Along it from p_mm: the arm behind, from and to; the arm ahead.
};

/// The two lines of a cross.
std::array<ArmLine, 2> armLines(const Cross& cross, const vision::PlaneMotion& X_TS);
/// Arms of a cross for the calipers, two for each line in turn: behind, ahead.
std::vector<dieline::Curve> armCurves(const std::array<ArmLine, 2>& lines);

struct MarkCentre {
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};
  Eigen::Matrix2d covariance{Eigen::Matrix2d::Zero()};
  double width_mm{};
};

/// Crossing of the two lines. Each is a parabola through the calipers of its two arms, weighted by their own
/// noise; what neighbouring calipers have in common is added whole. Or why there is no centre.
std::variant<MarkCentre, std::string> centreOf(const std::array<ArmLine, 2>& lines,
                                               const std::array<const vision::EntityKerf*, 4>& arms);

}  // namespace kerfbench::calibrate
