// SPDX-License-Identifier: Apache-2.0
#include "hil/command_line/completion.h"

#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/hil/command_line/sample_commands.h"

namespace kerfbench::command_line {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// The words that are offered, and ":files".
std::vector<std::string> offered(const std::vector<std::string>& words) {
  std::istringstream lines(completionsFor(sampleCommands(), words));
  std::vector<std::string> found;
  for (std::string line; std::getline(lines, line);) found.push_back(line.substr(0, line.find('\t')));
  return found;
}

TEST(Completion, OffersTheCommandsThatBeginSo) {
  EXPECT_THAT(offered({""}), ElementsAre("cut", "blade"));
  EXPECT_THAT(offered({"b"}), ElementsAre("blade"));
  EXPECT_THAT(offered({"x"}), IsEmpty());
  EXPECT_THAT(offered({}), ElementsAre("cut", "blade"));
  EXPECT_THAT(offered({"blade", ""}), ElementsAre("change", "sharpen"));
}

TEST(Completion, OffersTheOptionsOfTheCommandAndOfThoseAbove) {
  EXPECT_THAT(offered({"cut", "--"}), ElementsAre("--blade", "--speed", "--quiet", "--log", "--colour"));
  EXPECT_THAT(offered({"cut", "oak.txt", "--s"}), ElementsAre("--speed"));
  EXPECT_THAT(offered({"blade", "--"}), ElementsAre("--colour"));
}

TEST(Completion, OffersTheValuesOfAnOption) {
  EXPECT_THAT(offered({"cut", "--blade", ""}), ElementsAre("coarse", "fine"));
  EXPECT_THAT(offered({"cut", "-b", "f"}), ElementsAre("fine"));
  EXPECT_THAT(offered({"cut", "--blade=c"}), ElementsAre("--blade=coarse"));
  EXPECT_THAT(offered({"--colour", "n"}), ElementsAre("never"));
}

TEST(Completion, OffersFilesWhereAFileMayStand) {
  EXPECT_THAT(offered({"cut", ""}), ElementsAre(":files"));
  EXPECT_THAT(offered({"cut", "oak.txt", "elm"}), ElementsAre(":files"));
  EXPECT_THAT(offered({"cut", "--log", ""}), ElementsAre(":files"));
  EXPECT_THAT(offered({"cut", "--speed", ""}), IsEmpty());
  EXPECT_THAT(offered({"blade", "change", ""}), IsEmpty());
}

TEST(Completion, TakesAFlagForNoMoreThanItself) {
  EXPECT_THAT(offered({"cut", "-q", ""}), ElementsAre(":files"));
  EXPECT_THAT(offered({"cut", "--speed", "3", "--bl"}), ElementsAre("--blade"));
}

TEST(Completion, KnowsNoOptionsBehindTwoHyphens) {
  EXPECT_THAT(offered({"cut", "--", "--bl"}), ElementsAre(":files"));
}

TEST(Completion, SaysWhatAWordMeansInOneLine) {
  EXPECT_EQ(completionsFor(sampleCommands(), {"cut", "--sp"}), "--speed\tHow fast,\n");
}

TEST(CompletionScript, IsThereForThreeShellsAndNamesTheProgramAlone) {
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const auto script = completionScript(shell, "saw");
    ASSERT_TRUE(script) << shell;
    EXPECT_THAT(*script, HasSubstr("--complete"));
    EXPECT_THAT(*script, HasSubstr("saw"));
    EXPECT_EQ(script->find("PROGRAM"), std::string::npos);
    EXPECT_EQ(script->find("kerfbench"), std::string::npos);
  }
  EXPECT_FALSE(completionScript("csh", "saw"));
}

}  // namespace
}  // namespace kerfbench::command_line
