// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace kerfbench::twin {

/// Place of every part of a machine at one moment, in W.
struct MachinePose {
  double time_s{};
  double roller_mm{};       ///< Roller angle times radius, as the encoder sees it.
  double belt_travel_mm{};  ///< Travel of the belt's surface since t = 0.
  Eigen::Vector2d sheet_slip_mm{Eigen::Vector2d::Zero()};  ///< Slip of the sheet on the belt.
  /// Displacement of the frame, and with it of head and gantry.
  Eigen::Vector2d frame_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d gantry_mm{
      /// Place on the frame along the slides (not square to each other); zero without a gantry.
      Eigen::Vector2d::Zero()};
  /// Mechanical angles of X and Y mirror from rest as their encoders read them, before zero and scale; zero
  /// without mirrors.
  Eigen::Vector2d mirror_rad{Eigen::Vector2d::Zero()};
};

}  // namespace kerfbench::twin
