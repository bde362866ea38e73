// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "hil/base/exit_codes.h"

namespace kerfbench::instrument {

/// See reversalCommand().
struct ReversalCommandOptions {
  std::filesystem::path machine;
  std::filesystem::path results_dir{"results/head-reversal"};
  std::vector<double> turns_deg{
      180.0, 90.0};  ///< Angles by which the sheet is turned in the further views, counter-clockwise.
  int grid{9};       ///< Marks each way.
  std::filesystem::path table;  ///< Table with which the sheet is cut; empty: the machine file's, if any.
  std::uint64_t seed{1};
  std::string imperfections{"static"};
  std::string twin{"fast"};
  bool keep_pictures{};
  std::filesystem::path job;  ///< Job file of a sheet that was cut; empty: the twin cuts.
  std::vector<std::filesystem::path>
      pictures;  ///< Pictures of that sheet: the first as it lies, then turned.
  int jobs{1};
  bool quiet{};
  std::filesystem::path bin_dir;
  std::string command_line;
};

/// Tells the camera's own errors from the head's: a sheet is cut once, photographed, turned on the camera's
/// table and photographed again; what turns with it is the head's, what stays is the camera's. Writes
/// reversal.json. Returns 0; 3 for pictures that cannot be trusted; base::kExitInput.
int reversalCommand(const ReversalCommandOptions& options);

}  // namespace kerfbench::instrument
