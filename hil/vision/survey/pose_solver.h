// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/vision/survey/face_pose.h"

namespace kerfbench::vision {

// Parts of locateFace().

/// A mark in a view.
struct SightedMark {
  std::size_t view{};
  std::size_t mark{};
  Eigen::Vector2d pixel{Eigen::Vector2d::Zero()};  ///< Picture of the disc's centre.
  double sigma_px{};
};

/// The pixel of a point of W; nullopt behind the camera.
std::optional<Eigen::Vector2d> pixelOf(const CameraCalibration& calibration, const Eigen::Vector3d& p_W_mm);

/// A motion applied to a pose.
Eigen::Isometry3d moved(const SmallMotion& motion, const Eigen::Vector3d& centre_W_mm,
                        const Eigen::Isometry3d& X_WF);

/// The calibration with one standard deviation of an error mode added.
CameraCalibration withMode(const CameraCalibration& calibration, std::size_t mode);

/// Solves for the pose. nullopt if it does not settle.
std::optional<FacePose> solvePose(const ExpectedFace& face, const std::vector<SurveyView>& views,
                                  const std::vector<SightedMark>& sighted);

}  // namespace kerfbench::vision
