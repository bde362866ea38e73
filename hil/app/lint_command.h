// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hil/base/exit_codes.h"
#include "hil/dieline/read.h"
#include "hil/judge/run_options.h"

namespace kerfbench::app {

/// How drawings are checked that no scenario names.
struct LintDrawings {
  dieline::DrawingArguments arguments;
  std::filesystem::path scenario;     ///< Whose rules drawings are read by; empty: none.
  std::vector<std::string> accepted;  ///< Names of faults that are accepted where they touch no cut.
};

/// Checks a scenario, a machine or a dieline. `image`: as for runCommand(). Returns 0, or base::kExitInput
/// when something is wrong with a file.
int lintCommand(const std::vector<std::filesystem::path>& files, const std::filesystem::path& image,
                const LintDrawings& drawings, const judge::RunOptions& options);

}  // namespace kerfbench::app
