// SPDX-License-Identifier: Apache-2.0
#include "hil/app/history_command.h"

#include <vector>

#include <fmt/format.h>

#include "hil/base/atomic_file.h"
#include "hil/base/console.h"
#include "hil/base/input_error.h"
#include "hil/cli/run_guarded.h"

namespace kerfbench::app {

namespace fs = std::filesystem;

fs::path HistoryPlace::folder() const { return fs::is_directory(name) ? fs::path(name) : results_dir / name; }

int historyCommand(const HistoryPlace& place) {
  const fs::path folder = place.folder();
  return cli::runGuarded(folder, [&] {
    base::Console console(false);
    std::vector<std::string> problems;
    const std::vector<history::HistoryRow> rows = history::readHistory(folder, problems);
    for (const std::string& problem : problems) console.result("  left out: " + problem);
    if (rows.empty()) throw base::InputError(fmt::format("{}: holds no runs of a scenario", folder.string()));
    for (const std::string& line : history::historyLines(rows)) console.result(line);
    base::writeFileAtomically(folder / "history.html", history::historyPage(rows));
    console.say(fmt::format("page: {}", (folder / "history.html").string()));
    return 0;
  });
}

int pruneCommand(const HistoryPlace& place, const history::PruneOptions& options) {
  const fs::path folder = place.folder();
  return cli::runGuarded(folder, [&] {
    base::Console console(false);
    const history::Pruned pruned = history::prune(folder, options);
    for (const std::string& kept : pruned.kept) console.result(kept);
    for (const fs::path& removed : pruned.removed)
      console.result(fmt::format("{} {}", options.dry ? "would remove" : "removed", removed.string()));
    console.result(fmt::format("{} run{} {}", pruned.removed.size(), pruned.removed.size() == 1 ? "" : "s",
                               options.dry ? "to remove" : "removed"));
    return 0;
  });
}

}  // namespace kerfbench::app
