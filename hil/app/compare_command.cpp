// SPDX-License-Identifier: Apache-2.0
#include "hil/app/compare_command.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hil/base/console.h"
#include "hil/base/exit_codes.h"
#include "hil/base/input_error.h"
#include "hil/cli/run_guarded.h"
#include "hil/compare/write_comparison.h"
#include "hil/history/run_history.h"
#include "hil/judge/run_folder.h"
#include "hil/suite/suite_record.h"
#include "hil/suite/suite_result.h"

namespace kerfbench::app {
namespace {

namespace fs = std::filesystem;

constexpr int kExitWorse = 1;

/// The folder with the runs of the suite that is meant, if one is: itself, or the latest in the folder.
fs::path runsMeantBy(const fs::path& folder) {
  for (const fs::path& candidate : {folder, folder / judge::kLatestRun})
    if (fs::exists(candidate / suite::kSuiteRecord)) return candidate / "runs";
  return folder;
}

/// Whether a folder is that of a run of a suite. One that was set aside has a dot in its name.
bool isRunOfASuite(const fs::path& folder) {
  return folder.filename().string().find('.') == std::string::npos &&
         fs::exists(suite::resultsFolder(folder) / "verdict.json");
}

compare::RunSet oneRun(const fs::path& folder) {
  const fs::path run = isRunOfASuite(folder) ? suite::resultsFolder(folder) : history::runMeantBy(folder);
  return {run.string(), {compare::readRunFigures(run)}};
}

/// Scenarios whose runs a folder of results holds.
std::set<std::string> scenariosIn(const fs::path& results) {
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(results)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_directory() && !name.starts_with(".") &&
        (isRunOfASuite(entry.path()) || history::holdsRuns(entry.path())))
      names.insert(name);
  }
  return names;
}

bool holdsScenarios(const fs::path& folder) {
  return fs::is_directory(folder) && !fs::exists(folder / "verdict.json") && !history::holdsRuns(folder) &&
         !scenariosIn(folder).empty();
}

int tell(const compare::RunSet& before, const compare::RunSet& after, const fs::path& out,
         base::Console& console) {
  compare::ComparedReleases compared{before, after, compare::compareReleases(before, after)};
  compare::writeComparison(compared, out);
  const std::vector<std::string> lines = compare::comparisonLines(compared);
  for (std::size_t i = 0; i + 1 < lines.size(); ++i) console.say(lines[i]);
  console.result(fmt::format("{}: {}", before.runs.front().scenario, lines.back()));
  console.say(fmt::format("page: {}", (out / "compare.html").string()));
  return compared.comparison.anythingWorse() ? kExitWorse : 0;
}

int compareFolders(const CompareOptions& options, base::Console& console) {
  const std::set<std::string> before = scenariosIn(options.old_results),
                              after = scenariosIn(options.new_results);
  int code = 0;
  for (const std::string& name : before) {
    if (!after.contains(name)) {
      console.result(fmt::format("{}: the new release has no results of it", name));
      code = kExitWorse;
      continue;
    }
    code = base::worstExitCode(code, cli::runGuarded(options.new_results / name, [&] {
                                 return tell(oneRun(options.old_results / name),
                                             oneRun(options.new_results / name), options.out / name, console);
                               }));
  }
  for (const std::string& name : after)
    if (!before.contains(name)) console.say(fmt::format("{}: only the new release has results of it", name));
  return code;
}

/// All runs of the newest firmware, and all of the one that ran before it.
int compareHistory(const CompareOptions& options, base::Console& console) {
  std::vector<std::string> problems;
  std::vector<history::HistoryRow> rows = history::readHistory(options.history, problems);
  for (const std::string& problem : problems) console.result("  left out: " + problem);
  if (rows.empty())
    throw base::InputError(fmt::format("{}: holds no runs of a scenario", options.history.string()));
  const std::string newest = rows.back().figures.firmware_sha256;
  const auto other = std::ranges::find_if(rows.rbegin(), rows.rend(), [&](const history::HistoryRow& row) {
    return row.figures.firmware_sha256 != newest;
  });
  if (other == rows.rend())
    throw base::InputError(
        fmt::format("{}: all {} runs are of one firmware; there is nothing to compare it with",
                    options.history.string(), rows.size()));
  const std::string before = other->figures.firmware_sha256;
  // A seed that was run twice gives the same figures twice: the latest counts.
  const auto runsOf = [&](const std::string& sha256) {
    std::map<std::uint64_t, compare::RunFigures> by_seed;
    for (const history::HistoryRow& row : rows)
      if (row.figures.firmware_sha256 == sha256) by_seed[row.figures.seed] = row.figures;
    compare::RunSet set;
    for (auto& [seed, run] : by_seed) set.runs.push_back(std::move(run));
    set.name = fmt::format("{} run{} of {}", set.runs.size(), set.runs.size() == 1 ? "" : "s",
                           set.runs.front().firmware);
    return set;
  };
  return tell(runsOf(before), runsOf(newest), options.out, console);
}

}  // namespace

int compareCommand(const CompareOptions& options) {
  const fs::path& shown = options.history.empty() ? options.new_results : options.history;
  return cli::runGuarded(shown, [&] {
    base::Console console(options.quiet);
    if (!options.history.empty()) return compareHistory(options, console);
    for (const fs::path& folder : {options.old_results, options.new_results}) {
      if (!fs::is_directory(folder)) throw base::InputError(fmt::format("{}: is no folder", folder.string()));
    }
    CompareOptions meant = options;
    meant.old_results = runsMeantBy(options.old_results);
    meant.new_results = runsMeantBy(options.new_results);
    if (holdsScenarios(meant.old_results) && holdsScenarios(meant.new_results))
      return compareFolders(meant, console);
    return tell(oneRun(meant.old_results), oneRun(meant.new_results), options.out, console);
  });
}

}  // namespace kerfbench::app
