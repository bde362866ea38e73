// SPDX-License-Identifier: Apache-2.0
#include "hil/cli/cli.h"
#include "hil/cli/program.h"
#include "hil/window/cli.h"

namespace {

void addCommands(CLI::App& app, const kerfbench::cli::CliProgram& program,
                 kerfbench::cli::CliActions& actions) {
  kerfbench::window::addServe(app, program, actions);
  kerfbench::window::addView(app, program, actions);
}

}  // namespace

int main(int argc, char** argv) {
  return kerfbench::cli::guardedMain([argc, argv] {
    return kerfbench::cli::dispatch(argc, argv, kerfbench::cli::ProgramPart::kSomeCommands, addCommands);
  });
}
