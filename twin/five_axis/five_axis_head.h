// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "twin/five_axis/five_axis_description.h"

namespace kerfbench::twin {

/// The beam as it leaves the head: where it would be narrowest, and the unit vector from there to the head.
struct FiveAxisBeam {
  Eigen::Vector3d p_WQ_mm{Eigen::Vector3d::Zero()};
  Eigen::Vector3d axis_W{Eigen::Vector3d::UnitZ()};
};

/// Axes of the machine, as the control counts them.
struct FiveAxisPlaces {
  Eigen::Vector3d pivot_mm{Eigen::Vector3d::Zero()};
  double a_rad{};
  double c_rad{};
};

/// Kinematics of a five-axis head.
///
/// The control turns a pose (focus p, A, C) into places of the axes with what it was told, the pivot at
///
///     P = p + L axis(A, C),
///
/// rounded to whole steps. The machine as built has its focus at
///
///     p' = Q (P - p0) - L' axis(A', C') ,   Q = (1 s 0; 0 1 0; 0 0 1),
///
/// with the true distance L', the angles with their zeros and play, and the lean s of Y. p0 is the work zero:
/// it was touched off in W's origin with the head upright (A = C = 0), so that whatever the errors displace
/// there is in the zero already.
class FiveAxisHead {
 public:
  /// @throws std::invalid_argument that names everything wrong. The play lies in the middle.
  explicit FiveAxisHead(const FiveAxisDescription& description);

  /// Axis of a head at the angles, from the sheet towards the head; a unit vector.
  static Eigen::Vector3d axisOf(double a_rad, double c_rad);
  /// Places of the axes for a pose, in whole steps.
  [[nodiscard]] FiveAxisPlaces placesFor(const FiveAxisPose& pose) const;
  /// Moves the head to a pose and returns the beam there. The play of A and C depends on where they came
  /// from: to be called for places near each other.
  FiveAxisBeam moveTo(const FiveAxisPose& pose);

 private:
  [[nodiscard]] Eigen::Vector3d focusOf(const Eigen::Vector3d& pivot_mm, double a_rad, double c_rad) const;

  FiveAxisDescription description_;
  Eigen::Vector3d zero_mm_{Eigen::Vector3d::Zero()};
  bool moved_{false};
  double a_rad_{}, c_rad_{};  ///< Where the play has left the axes.
};

}  // namespace kerfbench::twin
