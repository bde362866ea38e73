// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/command_line/sample_commands.h"

namespace kerfbench::command_line {

CommandTree sampleCommands() {
  const OptionText board{.names = {"BOARD"},
                         .value = "TEXT",
                         .help = "Boards to cut",
                         .argument = true,
                         .required = true,
                         .several = true};
  const OptionText blade{
      .names = {"-b", "--blade"}, .choices = {"coarse", "fine"}, .help = "The blade", .standard = "fine"};
  const OptionText speed{.names = {"--speed"}, .value = "FLOAT", .help = "How fast,\nin m/s"};
  const OptionText quiet{.names = {"-q", "--quiet"}, .help = "Say nothing"};
  const OptionText log{.names = {"--log"}, .value = "TEXT", .help = "Where to write .notes"};
  const OptionText colour{.names = {"--colour"}, .choices = {"always", "never"}, .help = "Colours"};
  const CommandTree cut{
      .name = "cut", .help = "Cut boards: as marked.", .options = {board, blade, speed, quiet, log}};
  const CommandTree blades{.name = "blade",
                           .help = "What is done to blades",
                           .commands = {{.name = "change", .help = "Put in another"},
                                        {.name = "sharpen", .help = "Make it sharp"}}};
  return {.name = "saw",
          .help = "A saw.",
          .footer = "Exit codes: 0 done, 1 cut in the finger.",
          .options = {colour},
          .commands = {cut, blades}};
}

}  // namespace kerfbench::command_line
