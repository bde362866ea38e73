// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <memory>

#include "hil/app/cli.h"
#include "hil/app/trace_command.h"

namespace kerfbench::app {
namespace {

void addInfo(CLI::App& trace, cli::CliActions& actions) {
  const auto file = std::make_shared<std::filesystem::path>();
  CLI::App* command = trace.add_subcommand("info",
                                           "What a trace holds: run, topics, messages, times. Reads all of "
                                           "it and checks every sum. Exit code 1: it is\n"
                                           "cut off or damaged. Works while the run goes on.");
  command->add_option("FILE", *file, "run.mcap, or a file that still grows")->required();
  actions.add(command, [=] { return traceInfoCommand(*file); });
}

void addRecover(CLI::App& trace, cli::CliActions& actions) {
  const auto options = std::make_shared<TraceRecovery>();
  CLI::App* command = trace.add_subcommand(
      "recover",
      "Make a whole file of a trace that was cut off: all of its whole chunks, with index and sums");
  command->add_option("FILE", options->file, "The file that a killed run has left (*.mcap.part)")->required();
  command->add_option("--out,-o", options->out, "The whole file")->required();
  actions.add(command, options, traceRecoverCommand);
}

void addClip(CLI::App& trace, cli::CliActions& actions) {
  const auto options = std::make_shared<TraceClip>();
  CLI::App* command = trace.add_subcommand(
      "clip",
      "Make a trace of the time around a moment, with machine, checks and job, and all messages that hold\n"
      "anything of that time");
  command->add_option("FILE", options->file, "run.mcap")->required();
  command->add_option("--at", options->at_s, "The moment, simulated s")
      ->required()
      ->check(CLI::NonNegativeNumber);
  command->add_option("--around", options->around_s, "So long before and after it, s")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  command->add_option("--out,-o", options->out, "The trace of that time")->required();
  actions.add(command, options, traceClipCommand);
}

void addPage(CLI::App& trace, const cli::CliProgram& program, cli::CliActions& actions) {
  const auto options = std::make_shared<TracePage>();
  options->bin_dir = program.bin_dir;
  CLI::App* command = trace.add_subcommand("page",
                                           "Make a page that shows a small trace (trace clip) and stands "
                                           "alone: it needs no server and no network");
  command->add_option("FILE", options->file, "The trace, at most 64 MiB")->required();
  command->add_option("--at", options->at_s, "The moment at which it opens, simulated s")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--out,-o", options->out, "The page")->required();
  actions.add(command, options, tracePageCommand);
}

}  // namespace

void addTrace(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions) {
  CLI::App* trace = app.add_subcommand(
      "trace", "Traces of runs (run --trace, run.mcap): what is in them, whole ones of cut-off ones, parts");
  trace->require_subcommand(1);
  addInfo(*trace, actions);
  addRecover(*trace, actions);
  addClip(*trace, actions);
  addPage(*trace, program, actions);
}

}  // namespace kerfbench::app
