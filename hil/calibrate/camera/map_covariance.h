// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "hil/vision/image/camera_calibration.h"

namespace kerfbench::calibrate {

/// Fills error_modes and map_u_mm from the covariance of the parameters (in the order of error_modes).
///
/// The modes are the columns of L with L L^T = covariance, turned so that each moves the map of area_mm
/// independently of the others, the strongest first. Parameters may be badly known one by one where they
/// compensate each other; modes that move no point by a thousandth of the strongest are left out.
/// @throws std::invalid_argument for a covariance that is not finite or an empty area.
void setMapCovariance(const Eigen::Matrix<double, 15, 15>& covariance,
                      vision::CameraCalibration& calibration);

}  // namespace kerfbench::calibrate
