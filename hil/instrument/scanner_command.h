// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "hil/base/exit_codes.h"

namespace kerfbench::instrument {

/// See calibrateScannerCommand().
struct ScannerCommandOptions {
  std::filesystem::path scan;  ///< Picture of the whole glass with the target on it.
  std::filesystem::path
      target;  ///< Description of the target (`calibrate target` writes it), corrected as measured.
  double dpi{600.0};
  std::string id;    ///< Name of the scanner; empty: the file's name.
  std::string date;  ///< Day of the scan.
  std::filesystem::path out{"scanner.yaml"};
  bool quiet{};
};

/// Calibrates a flatbed scanner by one scan of the target and writes its calibration. Returns 0;
/// base::kExitInput: the scan is refused, nothing is written.
int calibrateScannerCommand(const ScannerCommandOptions& options);

}  // namespace kerfbench::instrument
