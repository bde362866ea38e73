// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/calibrate/tables/aim_grid.h"
#include "hil/calibrate/tables/table_faults.h"

namespace kerfbench::calibrate {

/// A grid as text with the rules of SCANLAB's RTC for theirs (RTC5 manual p. 176, RTC6 p. 240): lines
/// "x y dx dy" in mm of a complete rectangular grid in any order, spacing free; a correction is desired minus
/// measured, so it is added to the aim; bilinear inside, linear outside. ';' and '#' begin comments. The
/// rules and the sign are SCANLAB's, the file is not: their stretch table is of 1/mm of height, has a caption
/// of its own, and is clipped at 0.03125.
std::string gridText(const AimGrid& grid);

/// @throws TableFileError with every fault and its line.
AimGrid parseGridText(const std::string& text, const std::string& name);

}  // namespace kerfbench::calibrate
