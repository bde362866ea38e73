// SPDX-License-Identifier: Apache-2.0
#include "hil/history/run_history.h"

#include <algorithm>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "hil/base/input_error.h"
#include "hil/judge/results_list.h"
#include "hil/judge/run_folder.h"

namespace kerfbench::history {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVerdict = "verdict.json";

/// "20261128T160512Z-…" -> "2026-11-28 16:05:12".
std::string dateOf(const std::string& name) {
  return fmt::format("{}-{}-{} {}:{}:{}", name.substr(0, 4), name.substr(4, 2), name.substr(6, 2),
                     name.substr(9, 2), name.substr(11, 2), name.substr(13, 2));
}

}  // namespace

std::vector<KeptRun> runsIn(const fs::path& name_folder) {
  std::error_code error;
  std::vector<KeptRun> runs;
  for (const fs::directory_entry& entry : fs::directory_iterator(name_folder, error)) {
    const std::string name = entry.path().filename().string();
    if (!judge::isRunFolderName(name) || entry.is_symlink() ||
        !fs::exists(entry.path() / judge::kResultsList))
      continue;
    runs.push_back({entry.path(), dateOf(name)});
  }
  if (error) throw base::InputError(fmt::format("{}: {}", name_folder.string(), error.message()));
  // Names begin with the date.
  std::ranges::sort(runs, {}, [](const KeptRun& run) { return run.folder.filename().string(); });
  return runs;
}

bool holdsRuns(const fs::path& folder) {
  return fs::is_directory(folder) && !fs::exists(folder / kVerdict) && !runsIn(folder).empty();
}

fs::path runMeantBy(const fs::path& folder) {
  if (fs::exists(folder / kVerdict)) return folder;
  const std::vector<KeptRun> runs = runsIn(folder);
  if (runs.empty())
    throw base::InputError(
        fmt::format("{}: holds no verdict.json, and no runs of a scenario", folder.string()));
  return runs.back().folder;
}

std::vector<HistoryRow> readHistory(const fs::path& name_folder, std::vector<std::string>& problems) {
  std::vector<HistoryRow> rows;
  for (KeptRun& run : runsIn(name_folder)) {
    try {
      compare::RunFigures figures = compare::readRunFigures(run.folder, compare::Trust::kAsItIs);
      rows.push_back({std::move(run), std::move(figures)});
    } catch (const base::InputError& e) {
      problems.emplace_back(e.what());
    }
  }
  return rows;
}

Pruned prune(const fs::path& name_folder, const PruneOptions& options) {
  std::vector<std::string> unread;
  const std::vector<KeptRun> runs = runsIn(name_folder);
  std::set<fs::path> stays;
  const std::size_t keep = std::max<std::size_t>(1, options.keep);
  for (std::size_t i = runs.size() - std::min(keep, runs.size()); i < runs.size(); ++i)
    stays.insert(runs[i].folder);
  if (options.keep_worst) {
    std::set<std::string> releases;
    std::vector<HistoryRow> rows = readHistory(name_folder, unread);
    std::ranges::reverse(rows);
    for (const HistoryRow& row : rows) {
      if (row.figures.verdict != "PASS" && releases.insert(row.figures.firmware_sha256).second)
        stays.insert(row.run.folder);
    }
  }
  Pruned pruned;
  for (const KeptRun& run : runs) {
    if (stays.contains(run.folder)) continue;
    if (const std::string foreign = judge::foreignIn(run.folder); !foreign.empty()) {
      pruned.kept.push_back(fmt::format("{} stays: it {}", run.folder.string(), foreign));
      continue;
    }
    if (!options.dry) fs::remove_all(run.folder);
    pruned.removed.push_back(run.folder);
  }
  return pruned;
}

}  // namespace kerfbench::history
