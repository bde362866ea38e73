// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "hil/judge/run_options.h"

namespace kerfbench::app {

struct VerifyOptions {
  std::filesystem::path folder;       ///< Results of a run or of a replay.
  std::filesystem::path scenario;     ///< The scenario of that run; empty: its pins are not judged again.
  std::filesystem::path image;        ///< As for replayCommand().
  std::filesystem::path frames;       ///< As for replayCommand().
  std::optional<std::string> digest;  ///< Digest that was kept elsewhere.
  judge::RunOptions run;              ///< Threads and programs.
};

/// Whether a results folder is what a run wrote: the sums of its files, the sum of its pins, and with a
/// scenario all that follows from these pins. Returns 0; 1 if anything differs; base::kExitInput.
int verifyCommand(const VerifyOptions& options);

}  // namespace kerfbench::app
