// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "hil/vision/image/camera_calibration.h"

namespace kerfbench::calibrate {

/// A camera's calibration as it is kept, and what it was made for and from.
struct CalibrationFile {
  vision::CameraCalibration calibration;
  std::string described_camera;  ///< Fingerprint of the camera in the machine file at that time.
  std::size_t views{};
  std::size_t corners{};
};

/// The file's text. `made_by` is the command that makes it again, for its head.
std::string calibrationText(const CalibrationFile& file, const std::string& made_by);

/// @throws ConfigError with everything that is wrong: no such file, keys, ranges, a rotation that is none,
/// values that are not finite.
CalibrationFile readCalibrationFile(const std::filesystem::path& path);

}  // namespace kerfbench::calibrate
