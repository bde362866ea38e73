// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "hil/calibrate/scanner/scanner_map.h"

namespace kerfbench::calibrate {

/// YAML of a scanner's calibration. `made_by`: the command that makes it again.
std::string scannerText(const ScannerCalibration& scanner, const std::string& made_by);
/// @throws ConfigError with everything that is wrong.
ScannerCalibration readScannerFile(const std::filesystem::path& path);

}  // namespace kerfbench::calibrate
