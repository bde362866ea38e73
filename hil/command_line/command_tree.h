// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kerfbench::command_line {

/// An option or an argument of a command, as the program reads it.
struct OptionText {
  std::vector<std::string> names;    ///< "--seed", "-q"; of an argument its word in the help ("SCENARIO").
  std::string value;                 ///< Kind of its value ("TEXT", "FLOAT"); empty: none.
  std::vector<std::string> choices;  ///< All values that there are; empty: others.
  std::string help;
  std::string standard;  ///< Value that holds unless another is given; may be empty.
  bool argument{false};  ///< Known by its place, not by a name.
  bool required{false};
  bool several{false};  ///< Takes more than one value.

  [[nodiscard]] bool takesValue() const { return !value.empty() || !choices.empty(); }
  /// Whether the value may be a file's name.
  [[nodiscard]] bool takesFile() const { return choices.empty() && value.starts_with("TEXT"); }
};

/// A command with its options and the commands below it.
struct CommandTree {
  std::string name;
  std::string help;
  std::string footer;  ///< What the help ends with; may be empty.
  std::vector<OptionText> options;
  std::vector<CommandTree> commands;
  bool elsewhere{false};  ///< Another program alone knows its options.
};

}  // namespace kerfbench::command_line
