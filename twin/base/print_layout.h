// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace kerfbench {

/// A printed registration mark: a dark disc.
struct RegistrationMark {
  Eigen::Vector2d p_SM_mm{Eigen::Vector2d::Zero()};  ///< Centre, in the frame S of its unit.
  double diameter_mm{3.0};
};

/// Print other than a mark, as dark as one or paler: a stroke of a letter, a bar, a solid area. It is neither
/// mark nor cut.
struct PrintedArea {
  Eigen::Vector2d p_SA_mm{Eigen::Vector2d::Zero()};  ///< Centre of the rectangle, in the frame S of its unit.
  Eigen::Vector2d size_mm{Eigen::Vector2d::Zero()};  ///< Size along the rectangle's own axes; > 0.
  double angle_rad{};                                ///< Angle of its axes in S.
  double ink{1.0};                                   ///< Darkness: 0 no ink … 1 as dark as a mark.
};

/// The print of each unit on the web (a label, a carton, a piece of strip). The design of the print is known
/// to everybody: the dieline, the bench and the customer. Unit k lies at x_S = -k * pitch_mm on the web, so
/// unit 0 passes the head first when the belt runs along +Wx.
struct PrintLayout {
  int units{1};
  double pitch_mm{};  ///< > 0
  /// Leading edge of the eye mark that the print-mark sensor sees, in S of the unit.
  double eye_mark_x_mm{};
  double eye_mark_length_mm{5.0};       ///< Length along x, upstream of the leading edge.
  std::vector<RegistrationMark> marks;  ///< Marks of one unit.
  std::vector<PrintedArea> areas{};     ///< Areas of one unit.
};

}  // namespace kerfbench
