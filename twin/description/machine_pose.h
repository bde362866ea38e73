// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace kerfbench::twin {

/// Where everything of a machine is at one moment, in W.
struct MachinePose {
  double time_s{};
  double roller_mm{};       ///< Roller angle times radius: what the encoder sees.
  double belt_travel_mm{};  ///< Travel of the belt's surface since t = 0.
  Eigen::Vector2d sheet_slip_mm{Eigen::Vector2d::Zero()};  ///< Slip of the sheet on the belt.
  Eigen::Vector2d frame_mm{
      Eigen::Vector2d::Zero()};  ///< Displacement of the frame, and with it of head and gantry.
  Eigen::Vector2d gantry_mm{
      Eigen::Vector2d::Zero()};  ///< On the frame, along the slides (not square to each other); zero without.
  /// Mechanical angles of X and Y mirror from rest as their encoders tell them, before zero and scale; zero
  /// without mirrors.
  Eigen::Vector2d mirror_rad{Eigen::Vector2d::Zero()};
};

}  // namespace kerfbench::twin
