// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hil/base/exit_codes.h"

namespace kerfbench::app {

/// A picture of a machine, see showCommand().
struct ShowOptions {
  std::filesystem::path machine;   ///< May be empty where the scenario names it.
  std::filesystem::path scenario;  ///< Empty: the machine at rest.
  std::vector<double> at_s;        ///< Virtual times; none: the middle of the longest cut.
  std::filesystem::path out;       ///< Empty: named after machine or scenario, in the current folder.
  int width_px{1280};
  int height_px{800};
  std::string view{"overall"};  ///< overall, head, sheet.
  bool quiet{};
  std::filesystem::path bin_dir;
};

/// Draws a machine at rest, or as a run of the scenario has it at given times (by the fast twin). Several
/// times make several files, with the time in the name. Returns 0, base::kExitUsage, base::kExitInput, or
/// base::kExitBroken when POV-Ray is missing or fails.
int showCommand(const ShowOptions& options);

}  // namespace kerfbench::app
