// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/calibrate/camera/target_finder.h"

namespace kerfbench::calibrate {

/// Number of cells along each side of a picture, each of which must see a corner of the first view: 4 … 10,
/// of about 100 pixels.
int coverageCells(int width_px, int height_px);
/// Number of corners of a view in each cell of the picture, row by row.
std::vector<int> coverageOf(const std::vector<TargetCorner>& corners, int width_px, int height_px);
/// Parts of the picture with cells without a corner, in words; "" where there are none.
std::string coverageFault(const std::vector<TargetCorner>& corners, int width_px, int height_px);

}  // namespace kerfbench::calibrate
