// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "hil/judge/run_options.h"

namespace kerfbench::app {

/// Runs every scenario; returns the worst exit code (INVALID before FAIL before NOT PROVEN before PASS).
/// `image`: the release, whatever the scenarios name; empty: theirs.
int runCommand(const std::vector<std::filesystem::path>& scenarios, const std::filesystem::path& image,
               const judge::RunOptions& options);

/// What replayCommand() judges.
struct Replay {
  std::filesystem::path recording;
  std::filesystem::path scenario;
  std::filesystem::path image;   ///< The release, whatever the scenario names; empty: the scenario's.
  std::filesystem::path frames;  ///< Recording of a real spot camera; empty: the one beside the pins.
};

/// Judges a recording of pins as if it were live.
int replayCommand(const Replay& replay, const judge::RunOptions& options);

}  // namespace kerfbench::app
