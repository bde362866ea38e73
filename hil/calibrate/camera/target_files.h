// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "hil/calibrate/camera/target.h"

namespace kerfbench::calibrate {

/// Description of the target, to be kept with its print and corrected by what is measured there.
std::string targetText(const CalibrationTarget& target);
/// @throws ConfigError with everything that is wrong.
CalibrationTarget readTarget(const std::filesystem::path& path);

/// The target to print, true to scale in mm, with a margin of one square (10 mm at least), a ruler line and a
/// line that says what it is.
std::string targetSvg(const CalibrationTarget& target);

}  // namespace kerfbench::calibrate
