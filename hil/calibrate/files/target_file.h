// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "hil/calibrate/files/target.h"

namespace kerfbench::calibrate {

/// Description of the target, to be kept with its print and corrected by what is measured there.
std::string targetText(const CalibrationTarget& target);
/// @throws ConfigError with everything that is wrong.
CalibrationTarget readTarget(const std::filesystem::path& path);

}  // namespace kerfbench::calibrate
