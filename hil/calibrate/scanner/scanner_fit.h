// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/calibrate/files/target.h"
#include "hil/calibrate/scanner/scanner_map.h"
#include "twin/base/image_fwd.h"

namespace kerfbench::calibrate {

struct ScannerJob {
  CalibrationTarget target;  ///< As measured on its print: its squares are the scale.
  std::string scanner_id;
  std::string date;  ///< ISO 8601 day of the scan.
  double dpi{};      ///< Resolution that was asked of the scanner; 100 … 4800.
};

/// Calibrates a scanner by one scan of the whole glass with the target on it, face down: the map by linear
/// least squares over all corners, weighted by their covariances; the carriage's splines, one for each 8 mm,
/// are kept smooth by a prior (0.2 mm for the size of their second difference). How the target is turned on
/// the glass does not matter; the map does not turn with it.
/// @throws CalibrationError (hil/calibrate/camera) with everything that is wrong: a picture without light,
/// contrast or target; corners that reach over less than nine tenths of the glass along an axis; a resolution
/// that the squares contradict by more than 3 %; a target that lies askew by more than 10°; corners that
/// leave more than half a pixel.
ScannerCalibration calibrateScanner(const GrayImage& scan, const ScannerJob& job);

}  // namespace kerfbench::calibrate
