// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "hil/base/exit_codes.h"

namespace kerfbench::instrument {

/// See checkHeadCommand().
struct HeadCheckOptions {
  std::filesystem::path machine;
  std::filesystem::path calibration{"results/head"};  ///< Results of `calibrate head`.
  std::filesystem::path results_dir{"results/head-check"};
  std::filesystem::path table;  ///< Table of the controller; empty: the machine file's, or the calibration's.
  std::uint64_t seed{1};
  std::string imperfections{"static"};
  std::string twin{"fast"};
  bool keep_pictures{};
  bool by_hand{};
  std::filesystem::path image;     ///< Release of the controller, for a sheet that is cut by hand.
  std::filesystem::path scanner;   ///< Calibration of the scanner, for a sheet by hand that is scanned.
  std::filesystem::path job;       ///< Job file of a sheet that was cut; empty: the twin cuts, or people.
  std::filesystem::path pictures;  ///< Pictures of that sheet.
  std::string date;  ///< Day of the check; empty: today, of the twin that of the kerf camera's calibration.
  double limit_mm{0.010};         ///< Error of the beam towards which drifts are followed.
  std::filesystem::path history;  ///< Checks so far; empty: checks.jsonl in the results.
  int jobs{1};
  bool quiet{};
  std::filesystem::path bin_dir;
  std::string command_line;
};

/// Nine marks with the table, against the head as it was when it was calibrated: does the correction still
/// hold, and if not, which of zeros, gains, turn and height of the sheet changed? Adds the check to the
/// history, and writes check.json and check.html, which shows the trend over all checks. Returns
/// 0 if it holds, 1 if not; 3 for marks or pictures that cannot be trusted; base::kExitInput; by hand
/// base::kExitWaiting until there are pictures.
int checkHeadCommand(const HeadCheckOptions& options);

}  // namespace kerfbench::instrument
