// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "hil/base/exit_codes.h"
#include "hil/calibrate/head/head_parameters.h"

namespace kerfbench::instrument {

/// See calibrateHeadCommand().
struct HeadCalibrateOptions {
  std::filesystem::path machine;
  std::filesystem::path results_dir{
      "results/head"};  ///< Folder of this calibration alone; it goes on from there.
  std::vector<int> grids{3, 9, 17};
  int verify{400};
  double limit_mm{0.010};
  double unmodelled_share{calibrate::HeadTolerances{}.unmodelled_share};
  std::uint64_t seed{1};
  std::string imperfections{"static"};
  std::string twin{"fast"};
  std::string date;           ///< Empty: the kerf camera's calibration's.
  std::filesystem::path out;  ///< Empty: correction.csv in the results.
  bool keep_pictures{};
  bool by_hand{};  ///< People cut the sheets and photograph them.
  std::filesystem::path
      image;  ///< Release of the controller, for sheets cut by hand; empty: the native one for galvos.
  std::filesystem::path scanner;   ///< Calibration of the scanner, for sheets by hand that are scanned.
  std::filesystem::path job;       ///< Job file of a sheet that was cut; empty: the twin cuts.
  std::filesystem::path pictures;  ///< Pictures of that sheet: a folder with tiles.yaml.
  std::filesystem::path table;     ///< Table with which the sheet was cut; empty: the machine file's, if any.
  int jobs{1};
  bool quiet{};
  std::filesystem::path bin_dir;
  std::string command_line;
};

/// Calibrates a scan head by marks that the twin cuts, or by the pictures of a sheet that is cut; writes the
/// controller's correction table, what was measured, and a report. Returns 0; 1 if the table is not good
/// enough, 4 if it is not proven to be, 3 for marks or pictures that cannot be trusted, base::kExitInput:
/// then the table named by `out` is as it was. By hand base::kExitWaiting until the pictures of the next
/// sheet are there.
int calibrateHeadCommand(const HeadCalibrateOptions& options);

}  // namespace kerfbench::instrument
