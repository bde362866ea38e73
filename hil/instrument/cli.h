// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "hil/cli/cli.h"

namespace kerfbench::instrument {

/// Each adds commands with their options and help.
void addGauge(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions);
/// With all that is below it.
void addCalibrate(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions);
/// Below `calibrate`, beside `calibrate head`: check, reversal, table.
void addHeadTools(CLI::App& calibrate, const cli::CliProgram& program, cli::CliActions& actions);

}  // namespace kerfbench::instrument
