// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <vector>

#include "hil/calibrate/scanner/scanner_map.h"
#include "hil/vision/image/camera_calibration.h"
#include "twin/base/image.h"
#include "twin/base/print_layout.h"

namespace kerfbench::calibrate {

/// A scan that cannot be used; what() says why.
class ScanError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What lies behind the sheet in the scanner: a kerf is as dark as a black lid, as light as a white one.
enum class ScanLid { kBlack, kWhite };

/// Grey of an open kerf in a straightened scan.
inline constexpr double kScanOpenGray = 230.0;

/// A sheet as a kerf camera square above it would have taken it: kerfs bright, the board dark, print darker.
struct StraightScan {
  GrayImage image;
  /// Telecentric, without distortion. Its plane has the axes of the glass, and the sheet lies on it about as
  /// on its own frame S: the middle of the print is where the board has it.
  vision::CameraCalibration camera;
};

/// Straightens the part of a scan between its printed discs by the scanner's map (cubic convolution, Keys
/// 1981), and turns its greys into those of a back-lit picture. Discs are told from kerfs by their shape.
/// @throws ScanError: another number of printed discs than the board has; discs of another size, which is
/// another resolution; print that is as light as the board; a sheet that lies turned.
StraightScan straightened(const GrayImage& scan, const ScannerMap& map, ScanLid lid,
                          const std::vector<RegistrationMark>& print);

}  // namespace kerfbench::calibrate
