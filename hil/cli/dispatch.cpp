// SPDX-License-Identifier: Apache-2.0
#include "hil/cli/cli.h"

#include <algorithm>
#include <string>
#include <thread>

#include "hil/base/exit_codes.h"
#include "hil/base/installation.h"
#include "hil/base/shell_word.h"
#include "hil/base/version.h"
#include "hil/cli/program.h"
#include "hil/command_line/dialogue_cli.h"

namespace kerfbench::cli {
namespace {

/// The command line as the user would type it again: by ./bench where the bench was built, by its name where
/// it is installed.
std::string commandLine(const std::filesystem::path& bin_dir, int argc, char** argv) {
  std::string line = base::isInstalled(bin_dir) ? "kerfbench" : "./bench";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    // Who watches a run (--events) is no part of it: the report's command repeats the run.
    if (word == "--events") ++i;
    if (word == "--events" || word.starts_with("--events=")) continue;
    line += " " + base::shellWord(word);
  }
  return line;
}

}  // namespace

int dispatch(int argc, char** argv, ProgramPart part, AddCommands add_commands) {
  const CliProgram program{
      .bin_dir = binDir(),
      .argv = argv,
      .command_line = commandLine(binDir(), argc, argv),
      .jobs = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 256U)),
      .results = usualResults()};
  CLI::App app{
      "Kerfbench: hardware-in-the-loop test bench and digital twin for laser die-cutters.\n"
      "Takes a firmware release, lets it cut a dieline on a modelled machine, looks at the cut with a "
      "camera\n"
      "and says whether the release is good.",
      "kerfbench"};
  app.set_version_flag("--version", base::version());
  app.require_subcommand(1);
  app.fallthrough();  // --color stands before or behind the command.
  app.footer(
      "Exit codes: 0 PASS, 1 FAIL, 3 INVALID (the evidence cannot be trusted), 4 NOT PROVEN (inside the "
      "guard band),\n"
      "2 the bench itself broke, 64 wrong command line, 65 bad input file.\n"
      "Several scenarios: the worst of them, in the order 0, 4, 1, 3, 65, 2.");
  CliActions actions;
  add_commands(app, program, actions);
  command_line::Dialogue dialogue(app, base::version());
  if (part == ProgramPart::kSomeCommands) dialogue.onlyCommands();
  for (const auto& [command, become] : actions.elsewhere()) dialogue.handOver(command, become);
  if (const auto told = dialogue.read(argc, argv)) return *told;
  return actions.run().value_or(base::kExitUsage);
}

}  // namespace kerfbench::cli
