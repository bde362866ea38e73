// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/calibrate/tables/aim_grid.h"
#include "hil/calibrate/tables/table_faults.h"

namespace kerfbench::calibrate {

/// The reference controller's table. The convention stands in the file: header x_mm,y_mm,dx_mm,dy_mm, y
/// ascending and for each y all x ascending, W in mm; d is added to the aim; Hermite between nodes, nothing
/// outside. Numbers are written so that they read back to the last bit.
std::string csvTable(const AimGrid& grid);

/// @throws TableFileError with every fault and its line. Tables of steps are refused: how many mm a step is
///   depends on the machine and the place.
AimGrid parseCsvTable(const std::string& text, const std::string& name);

}  // namespace kerfbench::calibrate
