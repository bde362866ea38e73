// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "hil/command_line/command_tree.h"

namespace kerfbench::command_line {

/// The commands of a program as CLI11 knows them, without those that its help does not show.
CommandTree treeOf(const CLI::App& app);

}  // namespace kerfbench::command_line
