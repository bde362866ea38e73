// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/command_line/command_tree.h"

namespace kerfbench::command_line {

/// A page for man(1), section 1.
struct ManPage {
  std::string name;  ///< "kerfbench-calibrate-head": its file is that and ".1".
  std::string text;  ///< The page in roff.
};

/// Pages of the program and of each of its commands, but for those that are elsewhere. `version` stands at
/// the foot. There is no date in them: the same program has the same pages.
std::vector<ManPage> manPages(const CommandTree& program, const std::string& version);

}  // namespace kerfbench::command_line
