// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hil/command_line/command_tree.h"

namespace kerfbench::command_line {

/// The first word behind the program's name that is no command where one has to be, or no option of its
/// command, as a sentence with the nearest one that there is; nullopt if there is none.
std::optional<std::string> mistypedWord(const CommandTree& program, const std::vector<std::string>& words);

/// The command to which the words lead: "kerfbench calibrate head".
std::string commandNamed(const CommandTree& program, const std::vector<std::string>& words);

}  // namespace kerfbench::command_line
