// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/calibrate/camera/calibrate_camera.h"

namespace kerfbench::calibrate {

/// A picture (SVG) of what a calibration leaves: over the camera's picture, the mean residual of all views in
/// each of many cells as a magnified arrow, with its scale; grey the more corners a cell has, red where it
/// has none; and a table of the views. Arrows that hang together show a lens or a target that is not as
/// modelled.
std::string residualMapSvg(const CameraCalibrationResult& result);

}  // namespace kerfbench::calibrate
