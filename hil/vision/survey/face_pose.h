// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/vision/image/camera_calibration.h"
#include "twin/base/image_fwd.h"
#include "twin/base/print_layout.h"

namespace kerfbench::vision {

/// A camera that looks at a folded blank from a side, and its picture. The calibration's plane P is W's z =
/// 0, so that X_CP is the pose of the machine in the camera; CameraCalibration::error_modes are modes of
/// that.
struct SurveyView {
  const CameraCalibration* calibration{};
  const GrayImage* image{};
};

/// A flat face of a blank as it should stand.
struct ExpectedFace {
  std::string name;                                       ///< For messages.
  Eigen::Isometry3d X_WF{Eigen::Isometry3d::Identity()};  ///< z is the normal on the print's side.
  const PrintLayout* print{};                             ///< One unit; its S is F.
  double print_sigma_mm{};                                ///< Uncertainty of a mark's place, per axis.
  double search_mm{1.5};  ///< Farthest that a mark may lie from where it should, in the face's plane.
};

/// A small motion: turn about a point (rad, as a rotation vector in W) and shift (mm).
using SmallMotion = Eigen::Matrix<double, 6, 1>;

/// A face as it stands, by its marks.
struct FacePose {
  Eigen::Isometry3d X_WF{Eigen::Isometry3d::Identity()};
  Eigen::Vector3d centre_W_mm{Eigen::Vector3d::Zero()};  ///< Middle of the marks: turns are about it.
  /// Modes whose sum, weighted by independent standard normal values, is the pose's error: noise of the
  /// marks, print, and the calibration of each camera.
  std::vector<SmallMotion> modes;
  int marks{};      ///< Pictures of marks that were used.
  double rms_px{};  ///< Residual of the marks, per axis.

  /// Shift of a point fixed to the face by a mode, in W.
  [[nodiscard]] Eigen::Vector3d shift(const SmallMotion& mode, const Eigen::Vector3d& p_W_mm) const {
    return mode.tail<3>() + mode.head<3>().cross(p_W_mm - centre_W_mm);
  }
};

/// Pose of a face by bundle adjustment of its marks in all views at once: the motion that makes the squares
/// of what the pixels of all discs' centres differ from their projections, in units of their sigma, least
/// (Gauss and Newton, from the expected pose). Its covariance is (JᵀWJ)⁻¹, enlarged by chi² over its degrees
/// of freedom where marks agree worse than their sigmas; print and calibration come in by what a standard
/// deviation of theirs moves the solution.
///
/// Adds to `problems` and returns nullopt if a mark is seen by fewer than two views, fewer than three marks
/// there are, or the residual is larger than kMostRms_px: then print, fold or calibration is not what it is
/// taken for.
std::optional<FacePose> locateFace(const ExpectedFace& face, const std::vector<SurveyView>& views,
                                   std::vector<std::string>& problems);

inline constexpr double kMostRms_px = 0.3;

}  // namespace kerfbench::vision
