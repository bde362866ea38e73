// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace kerfbench::app {

/// Names the causes of runs by the evidence that --keep-evidence has left in their results folders, a line of
/// JSON for each file where `as_json`, else sentences. Returns 0; base::kExitInput for a file that is none.
int diagnoseCommand(const std::vector<std::filesystem::path>& files, bool as_json);

}  // namespace kerfbench::app
