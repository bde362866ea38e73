// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include "hil/app/ci_variable.h"
#include "hil/app/cli.h"
#include "hil/app/suite_command.h"

namespace kerfbench::app {
namespace {

/// What the options of the command fill, and those that may come without a value.
struct SuiteWords {
  suite::SuiteOptions options;
  std::filesystem::path resume, failed;
  std::size_t stop_after{};
};

/// Which runs of the plan, on which release.
void addChoiceOptions(CLI::App& command, SuiteWords& words) {
  suite::SuiteOptions& options = words.options;
  command.add_option("PLAN", options.plan, "The plan (fixtures/suites/*.yaml)")->required();
  command.add_option("--image", options.image,
                     "The release under test, instead of the images of all runs that take it");
  command.add_option("--tag", options.tags, "Only runs that have this tag; may be given several times")
      ->allow_extra_args(false);
  command
      .add_option("--only", options.patterns,
                  "Only runs whose name matches this pattern ('label-*'); may be given several times")
      ->allow_extra_args(false);
}

void addEarlierOptions(CLI::App& command, SuiteWords& words) {
  CLI::Option* const resume =
      command
          .add_option(
              "--resume", words.resume,
              "Go on with the suite in this folder, or with the latest one: runs that have no verdict "
              "yet are run")
          ->expected(0, 1);
  CLI::Option* const failed =
      command
          .add_option(
              "--failed", words.failed,
              "Only runs that were not as expected in the suite in this folder, or in the latest one, on "
              "its image unless another is given")
          ->expected(0, 1);
  resume->excludes(failed);
  for (const char* const chosen : {"--image", "--tag", "--only"}) resume->excludes(chosen);
}

void addRunOptions(CLI::App& command, SuiteWords& words) {
  suite::SuiteOptions& options = words.options;
  command.add_option("--results-dir", options.results_dir, "Folder for the results")->capture_default_str();
  command.add_option("--jobs,-j", options.jobs, "Runs at once; the results are the same at any number")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command
      .add_option("--stop-after", words.stop_after,
                  "Start no run after so many that were not as expected, instead of the plan's; 0: run all")
      ->check(CLI::Range(0, 1000000));
  command.add_flag("--list", options.list, "Check the plan and say what would be run; nothing is run");
  command.add_flag("--quiet,-q", options.quiet, "Only what is not as expected, and the result");
  command.add_flag("--keep-evidence", options.keep_evidence,
                   "Keep what the diagnosis goes by, for kerfbench diagnose");
  CLI::Option* const with = command.add_flag(
      "--pictures", options.pictures,
      "Pictures of the machine in the reports: they are there unless the environment variable\n"
      "CI is set, and neither empty nor false");
  command.add_flag("!--no-pictures", options.pictures, "No pictures of the machine in the reports")
      ->excludes(with);
}

}  // namespace

void addSuite(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions) {
  const auto words = std::make_shared<SuiteWords>();
  words->options.bin_dir = program.bin_dir;
  words->options.program = program.bin_dir / "kerfbench";
  words->options.jobs = program.jobs;
  words->options.results_dir = program.results;
  words->options.processors = program.jobs;
  words->options.pictures = !isCi(std::getenv("CI"));
  CLI::App* const command = app.add_subcommand(
      "suite",
      "Run a release test: all runs of a plan, several at once, each held against what is expected of it.\n"
      "results/NAME/DATE-DIGEST has a folder for each run, index.html, summary.json and junit.xml.\n"
      "Exit code: 0 if all runs are as expected, else the worst of the others, as of run; "
      "docs/how-to/release-test.md.");
  addChoiceOptions(*command, *words);
  addEarlierOptions(*command, *words);
  addRunOptions(*command, *words);
  actions.addStopping(command, [=] {
    suite::SuiteOptions options = words->options;
    if (command->count("--resume") > 0) options.resume = words->resume;
    if (command->count("--failed") > 0) options.failed = words->failed;
    if (command->count("--stop-after") > 0) options.stop_after = words->stop_after;
    return suiteCommand(options);
  });
}

}  // namespace kerfbench::app
