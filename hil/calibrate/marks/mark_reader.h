// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <variant>

#include "hil/calibrate/marks/mark_code.h"
#include "hil/calibrate/marks/mark_strokes.h"

namespace kerfbench::calibrate {

/// The number of a mark from the light in its slots, or why there is none.
std::variant<MarkReading, std::string> readTicks(const Cross& cross, const vision::TileIndex& tiles,
                                                 const vision::CameraCalibration& calibration,
                                                 double open_gray);

}  // namespace kerfbench::calibrate
