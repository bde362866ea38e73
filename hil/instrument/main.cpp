// SPDX-License-Identifier: Apache-2.0
#include "hil/cli/cli.h"
#include "hil/cli/program.h"
#include "hil/instrument/cli.h"

namespace {

void addCommands(CLI::App& app, const kerfbench::cli::CliProgram& program,
                 kerfbench::cli::CliActions& actions) {
  kerfbench::instrument::addCalibrate(app, program, actions);
  kerfbench::instrument::addGauge(app, program, actions);
}

}  // namespace

int main(int argc, char** argv) {
  return kerfbench::cli::guardedMain([argc, argv] {
    return kerfbench::cli::dispatch(argc, argv, kerfbench::cli::ProgramPart::kSomeCommands, addCommands);
  });
}
