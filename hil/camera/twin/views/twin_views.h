// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "hil/calibrate/camera/calibrate_camera.h"
#include "hil/calibrate/files/target.h"
#include "twin/camera/camera.h"
#include "twin/camera/target_board.h"

namespace kerfbench::camera {

/// A target held before a camera of the model: first flat on the plane, a little turned, then tilted by
/// 20 … 35° in all directions, near and far.
struct TwinViews {
  calibrate::CalibrationTarget target;
  calibrate::TargetPlace place;         ///< Place of the target in the first view.
  std::vector<Eigen::Isometry3d> X_CB;  ///< Poses of the camera in all views.
};

/// Squares of about 50 pixels, over the whole picture and beyond; coarser where the markers would not do.
calibrate::CalibrationTarget targetOf(const twin::CameraDescription& camera);
/// `tilted`: number of views after the first.
TwinViews twinViews(const twin::CameraDescription& camera, const calibrate::CalibrationTarget& target,
                    int tilted);

twin::TargetBoard boardOf(const calibrate::CalibrationTarget& target);

/// Fills target, place, size, views and picture of a job; pictures are rendered by seed and number when they
/// are asked for.
void setTwinViews(const twin::CameraDescription& camera, const TwinViews& views, std::uint64_t seed,
                  calibrate::CalibrationJob& job);

}  // namespace kerfbench::camera
