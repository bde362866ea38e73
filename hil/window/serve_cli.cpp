// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "hil/cli/program.h"
#include "hil/window/cli.h"
#include "hil/window/serve_command.h"

namespace kerfbench::window {
namespace {

void addServerOptions(CLI::App& command, ServeOptions& options) {
  command.add_option("--port", options.port, "Port; 0: one that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command
      .add_option("--address", options.address,
                  "Address at which the server listens, as a number. Other computers reach it at any but "
                  "127.0.0.1 and ::1,\nand nothing is encrypted")
      ->capture_default_str();
  command.add_flag("--open", options.open, "Start the browser (xdg-open)");
}

}  // namespace

void addServe(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions) {
  const auto options = std::make_shared<ServeOptions>();
  options->bin_dir = program.bin_dir;
  CLI::App* command = app.add_subcommand(cli::kServe.name, cli::kServe.help);
  command->add_option("FOLDER", options->folder, "Folder with scenarios, machines, drawings and results")
      ->check(CLI::ExistingDirectory)
      ->capture_default_str();
  command
      ->add_option("--bench", options->benches,
                   "Address of another bench, as its kerfbench serve has printed it, to be shown on the page "
                   "Station; may be "
                   "given\nseveral times")
      ->allow_extra_args(false);
  addServerOptions(*command, *options);
  actions.addStopping(command, [options] { return serveCommand(*options); });
}

void addView(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions) {
  const auto options = std::make_shared<ViewOptions>();
  options->serve.bin_dir = program.bin_dir;
  CLI::App* command = app.add_subcommand(cli::kView.name, cli::kView.help);
  command->add_option("TRACE", options->trace, "Trace of a run (run --trace), a file .mcap")->required();
  command->add_option("--at", options->at_s, "Moment at which it is opened, simulated seconds")
      ->check(CLI::NonNegativeNumber);
  addServerOptions(*command, options->serve);
  actions.addStopping(command, [options] { return viewCommand(*options); });
}

}  // namespace kerfbench::window
