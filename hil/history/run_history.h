// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "hil/compare/run_figures.h"

namespace kerfbench::history {

/// The results of one run among those of its scenario (results/NAME/DATE-DIGEST).
struct KeptRun {
  std::filesystem::path folder;
  std::string date;  ///< "2026-11-28 16:05:12" in UTC, by the folder's name.
};

/// The runs of a scenario, the oldest first: the folders in it that have a name as runs are given
/// (judge::isRunFolderName) and a list of results. Hidden folders, the link `latest` and what no run wrote
/// are left out.
/// @throws base::InputError if it is no folder.
std::vector<KeptRun> runsIn(const std::filesystem::path& name_folder);

/// The folder of the run that a user means: itself, if it holds a verdict; else the latest run in it.
/// @throws base::InputError: neither is there.
std::filesystem::path runMeantBy(const std::filesystem::path& folder);

/// Whether the folder holds the runs of one scenario.
bool holdsRuns(const std::filesystem::path& folder);

/// A run with what its verdict says.
struct HistoryRow {
  KeptRun run;
  compare::RunFigures figures;
};

/// Reads the verdicts of all runs, the oldest first. A run whose verdict cannot be read is left out, and told
/// in `problems`.
std::vector<HistoryRow> readHistory(const std::filesystem::path& name_folder,
                                    std::vector<std::string>& problems);

/// For a terminal: a line for each run with date, firmware, seed, verdict, and the checks nearest to their
/// limits.
std::vector<std::string> historyLines(const std::vector<HistoryRow>& rows);

/// history.html: the same as a page, with a plot of each measured check over the runs.
std::string historyPage(const std::vector<HistoryRow>& rows);

/// What prune() may remove.
struct PruneOptions {
  std::size_t keep{20};   ///< So many of the newest stay, at least one.
  bool keep_worst{true};  ///< The newest run of each release that did not PASS stays as well.
  bool dry{};             ///< Nothing is removed.
};

/// Runs that prune() removes or would remove, and why others stay that are older than what is kept.
struct Pruned {
  std::vector<std::filesystem::path> removed;
  std::vector<std::string> kept;  ///< "FOLDER stays: it holds 'notes.txt', which no run wrote"
};

/// Removes older runs of a scenario. The latest one, and folders that hold anything that no run wrote, always
/// stay.
/// @throws std::system_error if a folder cannot be removed.
Pruned prune(const std::filesystem::path& name_folder, const PruneOptions& options);

}  // namespace kerfbench::history
