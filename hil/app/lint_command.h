// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hil/app/drawing_choice.h"
#include "hil/base/exit_codes.h"
#include "hil/judge/run_options.h"

namespace kerfbench::app {

/// Checks scenarios, machines and dielines; "-" is one that comes on standard input, in the format `piped`
/// (an extension; empty: by its content), with file names relative to the current folder. `image`: as for
/// runCommand(). Returns 0, base::kExitInput when
/// something is wrong with a file, or base::kExitBroken where a second reader is wanted and there is none.
int lintCommand(const std::vector<std::filesystem::path>& files, const std::string& piped,
                const std::filesystem::path& image, const DrawingChoice& drawings,
                const judge::RunOptions& options);

}  // namespace kerfbench::app
