// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "hil/judge/run_options.h"

namespace kerfbench::app {

/// Runs every scenario; returns the worst exit code (INVALID before FAIL before NOT PROVEN before PASS).
int runCommand(const std::vector<std::filesystem::path>& scenarios, const judge::RunOptions& options);

/// Judges a recording of pins as if it were live. `frames`: of a real spot camera; empty: those beside the
/// pins.
int replayCommand(const std::filesystem::path& recording, const std::filesystem::path& scenario,
                  const std::filesystem::path& frames, const judge::RunOptions& options);

}  // namespace kerfbench::app
