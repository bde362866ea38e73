// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "hil/cli/cli.h"
#include "hil/dieline/read.h"

namespace kerfbench::app {

/// Each adds commands with their options and help.
void addShow(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions);
void addRecordFrames(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions);
void addCapture(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions);
void addCampaign(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions);
/// compare, history, prune.
void addHistory(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions);
/// trace info, recover, clip, page.
void addTrace(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions);
/// The release test of a plan.
void addSuite(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions);
void addDoctor(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions);
/// new, edit, plan.
void addDesk(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions);
/// --unit, --scale, --turn, --shift and --layer of a command that reads drawings.
void addReadingOptions(CLI::App& command, dieline::DrawingArguments& arguments);

}  // namespace kerfbench::app
