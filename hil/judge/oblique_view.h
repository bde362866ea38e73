// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/vision/image/camera_calibration.h"
#include "hil/vision/kerf/kerf_measurement.h"

namespace kerfbench::judge {

/// A kerf is a slit with walls: seen at an angle through board of thickness t, its visible middle lies t
/// tan(angle) / 2 beside its own at the face that the camera is calibrated for. The largest such shift of all
/// kerfs that were found, mm; 0 if there is none.
double obliqueShift_mm(const vision::KerfScan& scan, const vision::CameraCalibration& calibration,
                       double thickness_mm);

}  // namespace kerfbench::judge
