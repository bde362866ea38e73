// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/command_line/command_tree.h"

namespace kerfbench::command_line {

/// A program "saw" with the commands "cut BOARD... [--blade coarse|fine] [--speed FLOAT] [-q] [--log TEXT]"
/// and "blade change|sharpen", and an option --colour of all of them.
CommandTree sampleCommands();

}  // namespace kerfbench::command_line
