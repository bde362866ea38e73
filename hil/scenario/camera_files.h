// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hil/scenario/case.h"
#include "hil/vision/image/camera_calibration.h"
#include "twin/camera/camera.h"

namespace kerfbench::scenario {

/// Digest of what a machine file says of a camera's lens, mount and size: 16 hex digits. Another camera, or
/// one that was moved, has another.
std::string cameraFingerprint(const twin::CameraDescription& camera);

/// Cameras as the bench knows them.
struct BenchCameras {
  std::optional<vision::CameraCalibration> spot, kerf;  ///< Absent where there is a problem.
  std::vector<std::string> problems;  ///< Reasons not to use them, with the remedy; each makes a run INVALID.
  std::vector<std::pair<std::string, std::string>> facts;  ///< Lines for the report: camera, calibration.
};

/// Reads the calibrations that the machine file names. Refused are a file that is missing or cannot be read;
/// one of another camera, by id or by picture size; one made before the camera's description was changed; one
/// that at the scenario's date is older than its limit, or not made yet. No clock is read: without a date the
/// run is on the calibration's own day.
BenchCameras readCalibrations(const Case& test_case);

}  // namespace kerfbench::scenario
