// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "hil/app/cli.h"
#include "hil/app/compare_command.h"
#include "hil/app/history_command.h"

namespace kerfbench::app {
namespace {

void addCompare(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions) {
  const auto options = std::make_shared<CompareOptions>();
  options->out = program.results / "compare";
  CLI::App* compare = app.add_subcommand("compare",
                                         "Two releases beside each other: each check, entity, cut and joint "
                                         "with both values, their difference and its\n"
                                         "U, and whether it is significant; as text, compare.html and "
                                         "compare.json. Exit code 1: something got worse\n"
                                         "by more than its U, within the limits or not.");
  CLI::Option* const before = compare->add_option(
      "OLD", options->old_results,
      "Results of a run, the runs of a scenario or the suites of a plan (results/NAME: the latest counts),\n"
      "or a folder of such (results)");
  CLI::Option* const after = compare->add_option("NEW", options->new_results, "The same of the new release");
  before->needs(after);
  CLI::Option* const history = compare->add_option(
      "--history", options->history,
      "results/NAME: all runs of the newest firmware in it against all of the one before");
  history->excludes(before)->excludes(after);
  compare->add_option("--out,-o", options->out, "Folder for page and JSON")->capture_default_str();
  compare->add_flag("--quiet,-q", options->quiet, "Only the summary");
  compare->final_callback([=] {
    if (options->history.empty() && options->new_results.empty())
      throw CLI::RequiredError("OLD and NEW, or --history");
  });
  actions.add(compare, [=] { return compareCommand(*options); });
}

void addPlace(CLI::App& command, const cli::CliProgram& program, HistoryPlace& place) {
  place.results_dir = program.results;
  command.add_option("NAME", place.name, "The scenario's name, or the folder of its runs")->required();
  command.add_option("--results-dir", place.results_dir, "Folder with the results")->capture_default_str();
}

}  // namespace

void addHistory(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions) {
  addCompare(app, program, actions);

  const auto place = std::make_shared<HistoryPlace>();
  CLI::App* history = app.add_subcommand(
      "history",
      "The runs of a scenario over time: a line for each, and history.html with a plot of each check");
  addPlace(*history, program, *place);
  actions.add(history, [=] { return historyCommand(*place); });

  const auto pruned = std::make_shared<HistoryPlace>();
  const auto options = std::make_shared<history::PruneOptions>();
  CLI::App* prune = app.add_subcommand(
      "prune",
      "Remove older runs of a scenario. The latest stays, and a folder that holds what no run wrote");
  addPlace(*prune, program, *pruned);
  prune->add_option("--keep", options->keep, "So many of the newest stay")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  prune->add_flag("!--bad-too", options->keep_worst, "Also the newest run of each release that did not PASS");
  prune->add_flag("--dry-run", options->dry, "Only say what would be removed");
  actions.add(prune, [=] { return pruneCommand(*pruned, *options); });
}

}  // namespace kerfbench::app
