// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hil/base/console.h"

namespace kerfbench::suite {

/// What a suite is run with.
struct SuiteOptions {
  std::filesystem::path plan;
  std::filesystem::path results_dir{"results"};
  std::filesystem::path image;        ///< The release under test; empty: those that scenarios and plan name.
  std::vector<std::string> tags;      ///< See Selection.
  std::vector<std::string> patterns;  ///< See Selection.
  int jobs{1};                        ///< So many runs at once; >= 1.
  std::optional<std::size_t> stop_after;  ///< In place of the plan's; 0: all are run.
  /// Goes on with the suite in this folder; an empty path: the latest one of the plan.
  std::optional<std::filesystem::path> resume;
  /// Begins a suite of those runs that were not as expected in this one; an empty path: the latest.
  std::optional<std::filesystem::path> failed;
  bool list{};  ///< Says what would be run, and runs nothing.
  bool quiet{};
  bool pictures{};                ///< See judge::RunOptions.
  bool keep_evidence{};           ///< See judge::RunOptions.
  int processors{1};              ///< Threads of all runs together.
  std::filesystem::path bin_dir;  ///< Where kerfbench's children are.
  std::filesystem::path program;  ///< kerfbench, whose command `run` is started for each run.
};

/// Checks the plan, runs it, and writes results_dir/NAME/DATE-DIGEST: a folder for each run, index.html,
/// summary.json and junit.xml, anew after each run. A run is a child process, so that one which crashes is
/// one row of the table.
/// @returns the worst exit code of the runs that were not as expected, 0 if all were; 128 and the signal's
/// number if a signal stopped it. base::kExitBroken if the disk is full, with what ended kept.
/// @throws base::ConfigError, base::InputError before anything runs, with everything that is wrong.
int runSuite(const SuiteOptions& options, base::Console& console);

/// "5 of 12 runs (42 %), 1 not as expected, about 3 min left: label-seed-1, label-seed-2". `mean_s`: what an
/// ended run took; 0: none has ended, and no time is told. `at_once`: runs beside each other.
std::string progressText(std::size_t ended, std::size_t all, std::size_t bad, double mean_s, int at_once,
                         const std::vector<std::string>& running);

}  // namespace kerfbench::suite
