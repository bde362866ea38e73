// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Core>

namespace kerfbench::twin {

/// How far a five-axis head as built is from what its control was told.
struct FiveAxisErrors {
  double pivot_mm{};        ///< True distance from the pivot to the focus, less the nominal one; |.| <= 5.
  double a_zero_rad{};      ///< Added to every angle A; |.| <= 0.1, as the next.
  double c_zero_rad{};      ///< Added to every angle C.
  double a_backlash_rad{};  ///< Full play of A; 0 … 0.1, as the next.
  double c_backlash_rad{};  ///< Full play of C.
  double squareness_rad{};  ///< Lean of the Y axis towards +Wx; |.| <= 0.1.
};

/// A head with the axes X Y Z, C about Wz and A about the X that C has turned, whose axis from the sheet
/// towards the head is (sin C sin A, -cos C sin A, cos A). Both turns go through one point, the pivot.
struct FiveAxisDescription {
  double pivot_mm{120.0};          ///< Nominal distance from the pivot to the focus; 1 … 2000.
  double linear_step_mm{1e-3};     ///< Step of X, Y and Z; 1e-6 … 1.
  double turn_step_rad{1.745e-5};  ///< Step of A and C; 1e-9 … 0.1.
  double feed_mm_s{50.0};          ///< Speed of the focus along each line of the program; 0.1 … 1e4.
  double power_w{50.0};            ///< Power at that speed; 0.01 … 1e5.
  double waist_radius_mm{0.1};     ///< 1/e² radius in the focus; 0.031 … 2.
  double rayleigh_mm{10.0};        ///< Distance from the focus at which the area has doubled; 0.1 … 1e4.
  double turn_speed_rad_s{1.0};    ///< Speed of a turn in one place; 0.01 … 100.
  /// Whether the power goes with the speed of the focus (Wang, Li, Chen 2010), so that each millimetre gets
  /// the same energy and a turn in one place none. False: the power is constant, and a turn in one place
  /// burns.
  bool power_follows_speed{true};
  FiveAxisErrors errors{};
};

/// Everything that is wrong with a description, in one line; empty when nothing is.
std::string faultsOf(const FiveAxisDescription& head);

/// A pose of a program: place of the focus in W, and the angles of the head.
struct FiveAxisPose {
  Eigen::Vector3d p_WQ_mm{Eigen::Vector3d::Zero()};
  double a_rad{};
  double c_rad{};
};

/// A move of a program: straight from where the one before ended.
struct FiveAxisMove {
  FiveAxisPose to;
  bool cuts{};  ///< Beam on.
};

}  // namespace kerfbench::twin
