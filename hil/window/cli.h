// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "hil/cli/cli.h"

namespace kerfbench::window {

/// Each adds a command with its options and help.
void addServe(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions);
void addView(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions);

}  // namespace kerfbench::window
