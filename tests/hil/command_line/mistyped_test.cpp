// SPDX-License-Identifier: Apache-2.0
#include "hil/command_line/mistyped.h"

#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "tests/hil/command_line/sample_commands.h"

namespace kerfbench::command_line {
namespace {

std::optional<std::string> told(const std::vector<std::string>& words) {
  return mistypedWord(sampleCommands(), words);
}

TEST(MistypedWord, ThatShouldBeACommandIsToldWithTheNearest) {
  EXPECT_EQ(told({"ctu", "oak"}), "saw: there is no command 'ctu'. Did you mean cut?");
  EXPECT_EQ(told({"blade", "sharpne"}), "saw blade: there is no command 'sharpne'. Did you mean sharpen?");
  EXPECT_EQ(told({"paint"}), "saw: there is no command 'paint'.");
}

TEST(MistypedWord, ThatShouldBeAnOptionIsToldWithTheNearestOfItsCommand) {
  EXPECT_EQ(told({"cut", "oak", "--sped", "3"}),
            "saw cut: there is no option '--sped'. Did you mean --speed?");
  EXPECT_EQ(told({"cut", "--color=never"}), "saw cut: there is no option '--color'. Did you mean --colour?");
  EXPECT_EQ(told({"blade", "--speed", "3"}), "saw blade: there is no option '--speed'.");
}

TEST(MistypedWord, IsNoneWhereAllIsRightOrAnArgumentMayBeAnything) {
  EXPECT_EQ(told({"cut", "blade"}), std::nullopt);
  EXPECT_EQ(told({"cut", "--log", "cutt", "oak"}), std::nullopt);
  EXPECT_EQ(told({"cut", "--speed", "-3"}), std::nullopt);
  EXPECT_EQ(told({"cut", "--", "--sped"}), std::nullopt);
  EXPECT_EQ(told({}), std::nullopt);
  EXPECT_EQ(told({"", "cut", "oak"}), std::nullopt);
}

TEST(MistypedWord, FromSomebodyElseCannotCommandATerminal) {
  EXPECT_EQ(told({"\x1b[2J"}), "saw: there is no command '?[2J'.");
}

TEST(CommandNamed, IsThePathThatTheWordsTake) {
  EXPECT_EQ(commandNamed(sampleCommands(), {"--colour", "never", "blade", "change"}), "saw blade change");
  EXPECT_EQ(commandNamed(sampleCommands(), {"cut", "oak", "--nonsense"}), "saw cut");
  EXPECT_EQ(commandNamed(sampleCommands(), {}), "saw");
}

}  // namespace
}  // namespace kerfbench::command_line
