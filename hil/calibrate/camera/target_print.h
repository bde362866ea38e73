// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hil/calibrate/files/target.h"

namespace kerfbench::calibrate {

/// Cells of a marker as printed, row by row, border included: 0 black, 1 white. @throws std::out_of_range.
std::vector<std::uint8_t> markerCells(int marker);

/// The target to print, true to scale in mm, with a margin of one square (10 mm at least), a ruler line and a
/// line that says what it is.
std::string targetSvg(const CalibrationTarget& target);

}  // namespace kerfbench::calibrate
