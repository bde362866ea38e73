// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace kerfbench::app {

struct CompareOptions {
  std::filesystem::path old_results, new_results;
  /// Runs of a scenario: the newest firmware against the one before; the other two are empty then.
  std::filesystem::path history;
  std::filesystem::path out{"results/compare"};  ///< Folder for compare.html and compare.json.
  bool quiet{};
};

/// Compares releases by their results: of one run each, or of all scenarios in two folders of results.
/// Returns 1 if something got worse, or a scenario of the old release has no results of the new one.
int compareCommand(const CompareOptions& options);

}  // namespace kerfbench::app
