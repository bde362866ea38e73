// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "hil/history/run_history.h"

namespace kerfbench::app {

/// Where the runs of a scenario are.
struct HistoryPlace {
  std::filesystem::path results_dir{"results"};
  std::string name;  ///< The scenario's, or the path of its folder.

  /// results_dir/name, or name where it is a folder.
  [[nodiscard]] std::filesystem::path folder() const;
};

/// A line for each run, and history.html in the scenario's folder.
int historyCommand(const HistoryPlace& place);

/// Removes older runs of a scenario; tells which.
int pruneCommand(const HistoryPlace& place, const history::PruneOptions& options);

}  // namespace kerfbench::app
