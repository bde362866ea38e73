// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "hil/app/cli.h"
#include "hil/app/lint_command.h"
#include "hil/app/run_command.h"
#include "hil/app/run_guarded.h"
#include "hil/base/exit_codes.h"
#include "hil/base/freed_memory.h"
#include "hil/base/version.h"
#include "hil/judge/run_options.h"
#include "hil/scenario/scenario.h"

namespace {

namespace fs = std::filesystem;
using namespace kerfbench;
using namespace kerfbench::app;

std::string commandLine(int argc, char** argv) {
  std::string line = "./bench";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool plain = !word.empty() && word.find_first_of(" \t'\"$`\\*?;&|<>()") == std::string::npos;
    line += plain ? " " + word : " '" + word + "'";
  }
  return line;
}

std::shared_ptr<judge::RunOptions> commonOptions(const CliProgram& program) {
  auto options = std::make_shared<judge::RunOptions>();
  options->bin_dir = program.bin_dir;
  options->command_line = program.command_line;
  options->jobs = program.jobs;
  return options;
}

void addCommonOptions(CLI::App& command, judge::RunOptions& options) {
  command.add_option("--results-dir", options.results_dir, "Folder for the results")->capture_default_str();
  command.add_option("--seed", options.seed,
                     "Seed of all noise and of what the imperfections draw, instead of the scenario's");
  command
      .add_option("--time-limit", options.time_limit_s,
                  "Seconds after which a run is INVALID: virtual ones, on real pins real ones")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--imperfections", options.imperfections,
                  "How far the machine is from its description: ideal, static (set-up),\n"
                  "dynamic (static, and lag, play, slip, flutter, noise); instead of the scenario's")
      ->check(CLI::IsMember(
          std::vector<std::string>(scenario::kPresetNames.begin(), scenario::kPresetNames.end())));
  command
      .add_option("--twin", options.twin,
                  "How the equations of motion are solved: reference (Bullet, step by step)\nor fast; "
                  "instead of the scenario's")
      ->check(CLI::IsMember(
          std::vector<std::string>(scenario::kFidelityNames.begin(), scenario::kFidelityNames.end())));
  command.add_option("--jobs,-j", options.jobs, "Threads; the results are the same at any number")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command.add_flag("--quiet,-q", options.quiet, "Only the verdict");
  command.add_flag("--timing", options.timing, "Say where the time went");
  command.add_flag("!--no-pictures", options.pictures,
                   "No pictures of the machine in the report: saves a few seconds");
}

void addRun(CLI::App& app, const CliProgram& program, CliActions& actions) {
  CLI::App* run = app.add_subcommand(
      "run",
      "Run scenarios: firmware, machine, camera, verdict, report.\nA scenario on real pins (source: gpio, "
      "analyser) runs in real time; docs/how-to/real-pins.md has its keys.");
  const auto scenarios = std::make_shared<std::vector<fs::path>>();
  const auto options = commonOptions(program);
  run->add_option("SCENARIO", *scenarios, "Scenario files (fixtures/scenarios/*.yaml)")->required();
  addCommonOptions(*run, *options);
  actions.add(run, [=] { return runCommand(*scenarios, *options); });
}

void addReplay(CLI::App& app, const CliProgram& program, CliActions& actions) {
  struct Files {
    fs::path recording, scenario, frames;
  };
  const auto files = std::make_shared<Files>();
  const auto options = commonOptions(program);
  CLI::App* replay = app.add_subcommand("replay", "Judge recorded pins (pins.vcd, .sr) as if they were live");
  replay
      ->add_option("RECORDING", files->recording,
                   "VCD file with 1-bit wires named like galvo_x_pul,\nor a session file of sigrok (.sr), "
                   "channels named so or as the scenario's lines")
      ->required();
  replay->add_option("--scenario", files->scenario, "The scenario that was recorded")->required();
  replay->add_option("--frames", files->frames,
                     "Recording of the real spot camera that the scenario names;\notherwise the folder spot "
                     "beside the pins");
  addCommonOptions(*replay, *options);
  actions.add(replay,
              [=] { return replayCommand(files->recording, files->scenario, files->frames, *options); });
}

void addLint(CLI::App& app, const CliProgram& program, CliActions& actions) {
  CLI::App* lint = app.add_subcommand("lint", "Check scenarios, machines (.yaml) and dielines (.dxf, .svg)");
  const auto files = std::make_shared<std::vector<fs::path>>();
  const auto options = commonOptions(program);
  lint->add_option("FILE", *files, "Files to check")->required();
  lint->add_flag("--quiet,-q", options->quiet, "Only what is wrong");
  actions.add(lint, [=] { return lintCommand(*files, *options); });
}

int dispatch(int argc, char** argv) {
  const CliProgram program{
      .bin_dir = fs::read_symlink("/proc/self/exe").parent_path(),
      .command_line = commandLine(argc, argv),
      .jobs = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 256U))};
  CLI::App app{
      "Kerfbench: hardware-in-the-loop test bench and digital twin for laser die-cutters.\n"
      "Takes a firmware release, lets it cut a dieline on a modelled machine, looks at the cut with a "
      "camera\n"
      "and says whether the release is good.",
      "kerfbench"};
  app.set_version_flag("--version", kerfbench::base::version());
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 PASS, 1 FAIL, 3 INVALID (the evidence cannot be trusted), 4 NOT PROVEN (inside the "
      "guard band),\n"
      "2 the bench itself broke, 64 wrong command line, 65 bad input file.\n"
      "Several scenarios: INVALID outweighs FAIL, FAIL outweighs NOT PROVEN.");
  // In the order of the help.
  CliActions actions;
  addRun(app, program, actions);
  addReplay(app, program, actions);
  addRecordFrames(app, program, actions);
  addCapture(app, program, actions);
  addLint(app, program, actions);
  addDoctor(app, program, actions);
  addShow(app, program, actions);
  addCalibrate(app, program, actions);
  addGauge(app, program, actions);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    const int code = app.exit(e);  // Prints help, version or the fault.
    return code == 0 ? 0 : base::kExitUsage;
  }
  return actions.run().value_or(base::kExitUsage);
}

}  // namespace

int main(int argc, char** argv) {
  kerfbench::base::keepFreedMemory();
  try {
    return dispatch(argc, argv);
  } catch (const std::exception& e) {
    std::fputs(fmt::format("kerfbench: the bench itself broke: {}\n", e.what()).c_str(), stderr);
    return base::kExitBroken;
  }
}
