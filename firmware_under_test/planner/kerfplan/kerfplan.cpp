// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/kerfplan/kerfplan.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "firmware_under_test/planner/head/correction.h"
#include "firmware_under_test/planner/kerfplan/drawing_options.h"
#include "firmware_under_test/planner/kerfplan/idle_options.h"
#include "firmware_under_test/planner/kerfplan/job_text.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_compensate.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_library.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_loop.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_options.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_own_job.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_power.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_strip.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_summary.h"
#include "firmware_under_test/planner/kerfplan/output_text.h"
#include "firmware_under_test/planner/preview/preview.h"
#include "firmware_under_test/planner/program/check.h"
#include "firmware_under_test/planner/program/order_table.h"
#include "firmware_under_test/planner/program/plan.h"
#include "firmware_under_test/planner/program/program.h"
#include "hil/base/installation.h"
#include "hil/base/terminal.h"
#include "hil/base/version.h"
#include "hil/command_line/dialogue_cli.h"
#include "hil/dieline/read.h"

namespace kerfbench::planner {
namespace {

constexpr int kBadInput = 65;
constexpr int kBroken = 2;

/// Prints all errors to standard error, or the demands of the job.
int check(const KerfplanOptions& options, const std::string& gcode) {
  const CheckResult checked = checkJob(gcode, options.machine, options.job, options.faults);
  for (const std::string& warning : checked.warnings) base::toTerminal(stderr, "warning: " + warning + "\n");
  for (const std::string& error : checked.errors) base::toTerminal(stderr, withFile(options, error) + "\n");
  if (!checked.errors.empty()) return kBadInput;
  const Plan plan = planFromChecked(checked, gcode, options.machine, options.job, options.faults);
  base::toTerminal(stdout, summaryOf(options.input.empty() ? options.scenario : options.input, checked, plan,
                                     options.machine, options.job));
  return 0;
}

/// Adds a command that takes a drawing or G-code.
CLI::App* jobCommand(CLI::App& app, KerfplanOptions& options, const char* name, const char* help,
                     bool writes) {
  CLI::App* sub = app.add_subcommand(name, help);
  sub->add_option(
      "DIELINE", options.input,
      "A drawing (.dxf, .svg, .pdf, .cf2), or G-code (.nc, .ngc, .gcode, .tap, .txt; - from standard "
      "input); with --scenario, in place of its own");
  if (writes) sub->add_option("-o,--output", options.output, "File to write instead of standard output");
  const auto choice = [&](const char* option, std::string& value, const char* meaning) {
    sub->add_option(option, value, meaning)->group("What is cut (all, if nothing is said)");
  };
  choice("--entities", options.entities, "Only these entities, by id: 3,5-8");
  choice("--layers", options.layers, "Only these layers (or SVG colours) of a drawing: cut,crease");
  choice("--process", options.processes, "Only these processes: cut, half-cut, crease, perforation");
  addDrawingOptions(*sub, options.drawing);
  addMachineOptions(*sub, options);
  sub->add_option("--correction", options.correction,
                  "CSV table of what the head's formula leaves: x_mm,y_mm,dx_mm,dy_mm")
      ->group("Machine");
  addJobOptions(*sub, options.job);
  addPowerOptions(*sub, options.power);
  sub->final_callback([sub, &options] {
    if (options.waitForFiles()) return;
    if (options.input.empty() && options.scenario.empty()) throw CLI::RequiredError("DIELINE or --scenario");
    refuseIdleOptions(
        *sub, {options.machine, options.job, options.power, options.hasGcode(), !options.scenario.empty()});
  });
  return sub;
}

/// Commands as parsed.
struct Commands {
  const CLI::App* gcode;
  const CLI::App* program;
  const CLI::App* preview;
  const CLI::App* order;
  const CLI::App* power_loop;
};

Commands addCommands(CLI::App& app, KerfplanOptions& options) {
  const auto subcommand = [&](const char* name, const char* help, bool writes) {
    return jobCommand(app, options, name, help, writes);
  };
  const CLI::App* gcode = subcommand("gcode", "Write the G-code of one unit, to read or to edit", true);
  CLI::App* program = subcommand(
      "program", "Write the controller's program of all units: an operation per line in hex, or in C", true);
  addOwnJobOptions(*program, options.own_job);
  const CLI::App* preview = subcommand(
      "preview", "Write a page that plays the job: one HTML file, nothing loaded from elsewhere", true);
  const CLI::App* order = subcommand(
      "order", "Compare the orders in which a drawing can be cut: air path, time, highest belt speed", false);
  subcommand("check", "Say whether and how the job fits the machine", false);
  CLI::App* loop = subcommand(
      "power-loop",
      "Compare laws of the loop on the measured power over the marks of a job (with --material, --laser and "
      "--depth): the paper's P(k+1) = P(k) + (P_out - P_f) and the damped one; with -o as a plot (SVG)",
      true);
  loop->add_option("--tube", options.loop.tube, "Power of the tube over its nominal one")
      ->capture_default_str();
  loop->add_option("--late", options.loop.late_periods, "Periods until a measurement can be used")
      ->capture_default_str();
  return {gcode, program, preview, order, loop};
}

/// Compares laws of the power loop over all marks of one unit.
void comparePowerLoops(const KerfplanOptions& options, const std::string& gcode) {
  if (!options.job.power) throw PowerError("power-loop needs --material, --laser and --depth");
  const CheckResult checked = checkJob(gcode, options.machine, options.job);
  if (!checked.solution) throw PlanError(fmt::format("{}", fmt::join(checked.errors, "\n")));
  LoopCase loop = options.loop;
  const LaserTube& laser = options.job.power->laser();
  loop.limits = {laser.least_w, laser.most_w};
  loop.period_s = options.machine.target.periodS();
  std::vector<double> wanted_w;
  for (const Block& block : checked.solution->paths.front().blocks) {
    for (const Sample& sample : block.samples) {
      if (sample.marked_mm > 0.0)
        wanted_w.push_back(powerSetting(sample, options.machine, options.job).power_w);
    }
  }
  if (!options.output.empty()) {
    writeOutput(options.output, loopPlot(wanted_w, loop));
    if (options.output == "-") return;
  }
  base::toTerminal(stdout, loopTable(wanted_w, loop));
}

/// Writes the controller's program: operations, or the source of a control program that holds them.
void writeProgram(const KerfplanOptions& options, const std::string& gcode) {
  if (options.own_job.target == OwnJobOptions::Target::kMcs51) {
    writeOutput(options.output,
                ownJobSource(options.own_job, nameOf(options), gcode, options.machine, options.job));
    return;
  }
  writeOutput(options.output,
              programText(planFromGcode(gcode, options.machine, options.job, options.faults).program));
}

/// Runs a command that takes the G-code of a unit; returns the exit code.
int runWithText(const Commands& commands, const KerfplanOptions& options) {
  const std::string text = gcodeOf(options);
  if (commands.gcode->parsed()) {
    writeOutput(options.output, text);
  } else if (commands.power_loop->parsed()) {
    comparePowerLoops(options, text);
  } else if (commands.preview->parsed()) {
    writeOutput(options.output,
                previewHtml(nameOf(options), text, options.machine, options.job, options.faults));
  } else if (commands.program->parsed()) {
    writeProgram(options, text);
  } else {
    return check(options, text);
  }
  return 0;
}

/// Runs the commands; returns the exit code.
int run(const Commands& commands, const StripCommands& strip, KerfplanOptions& options) {
  if (!options.image.empty()) options.machine.target = targetOfImage(options.image);
  if (strip.run()) return 0;
  if (!options.correction.empty())
    options.machine.correction = std::make_shared<CorrectionTable>(CorrectionTable::read(options.correction));
  if (auto power = powerModelOf(options.power)) options.job.power = std::move(power);
  if (commands.order->parsed()) {
    if (options.hasGcode()) throw PlanError(nameOf(options) + ": an order is chosen for a drawing");
    base::toTerminal(stdout, orderTable(chosenOf(options), options.machine, options.job));
    return 0;
  }
  try {
    return runWithText(commands, options);
  } catch (const PlanError& error) {
    throw PlanError(withFile(options, error.what()));
  }
}

/// Lets the program that has the bench's readers take this process over with the same command line.
[[noreturn]] void becomeCaseProgram(char** argv) {
  const std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / kCaseProgram;
  ::execv(program.c_str(), argv);
  const int error = errno;
  if (error != ENOENT) throw std::system_error(error, std::generic_category(), program.string());
  throw PlanError(fmt::format("--scenario and --machine are read by {}, which is not {}", program.string(),
                              base::isInstalled(program.parent_path())
                                  ? "installed: install the package kerfbench"
                                  : "built: ./bench kerfplan with one of them builds it"));
}

/// Reads the files that were named: what they say takes the place of the options' defaults.
void takeFiles(KerfplanOptions& options, const KerfplanOptions& named, const CaseReader& read_case) {
  PlannedCase read = read_case({.scenario = named.scenario,
                                .machine = named.machine_file,
                                .image = named.image,
                                .drawing = named.hasGcode() ? "" : named.input,
                                .has_gcode = named.hasGcode()},
                               options.job);
  options.machine = read.machine;
  options.job = read.job;
  options.job.given_by = GivenBy::kCommandLine;
  options.faults = read.faults;
  options.planned = std::move(read);
}

/// One reading of the command line: with files named in it, and not read, nothing is done.
std::optional<int> once(int argc, char** argv, KerfplanOptions& options) {
  CLI::App app{
      "Plans the laser die-cutting of a dieline: order, G-code, motion, laser power, controller program.\n"
      "Exit codes: 0 it fits, 65 it does not or a file is wrong, 64 wrong command line, 2 the program "
      "broke.",
      "kerfplan"};
  app.set_version_flag("--version", base::version());
  app.require_subcommand(1);
  app.fallthrough();
  const Commands commands = addCommands(app, options);
  const StripCommands strip(app, options.machine, options.job, [&](CLI::App& command) {
    addMachineOptions(command, options);
    addJobOptions(command, options.job);
  });
  const CompensateCommand compensate(app);
  const ProveCommand prove(app);
  const PowerCommand power(app);
  const LibraryCommand library(app);
  command_line::Dialogue dialogue(app, base::version());
  if (const auto told = dialogue.read(argc, argv)) return told;
  if (options.waitForFiles()) return std::nullopt;
  if (compensate.run() || prove.run() || power.run() || library.run()) return 0;
  return run(commands, strip, options);
}

}  // namespace

int kerfplanMain(int argc, char** argv, const CaseReader& read_case) try {
  KerfplanOptions named;
  if (const auto done = once(argc, argv, named)) return *done;
  if (!read_case) becomeCaseProgram(argv);
  KerfplanOptions options;
  takeFiles(options, named, read_case);
  return once(argc, argv, options).value_or(kBroken);
} catch (const PlanError& error) {
  base::toTerminal(stderr, fmt::format("{}\n", error.what()));
  return kBadInput;
} catch (const PowerError& error) {
  base::toTerminal(stderr, fmt::format("{}\n", error.what()));
  return kBadInput;
} catch (const dieline::DielineError& error) {
  base::toTerminal(stderr, fmt::format("{}\n", error.what()));
  return kBadInput;
} catch (const std::system_error& error) {
  base::toTerminal(stderr, fmt::format("{}\n", error.what()));
  return kBadInput;
} catch (const std::exception& error) {
  base::toTerminal(stderr, fmt::format("kerfplan: {}\n", error.what()));
  return kBroken;
}

}  // namespace kerfbench::planner
