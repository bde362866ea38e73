// SPDX-License-Identifier: Apache-2.0
#include "hil/command_line/man_page.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/hil/command_line/sample_commands.h"

namespace kerfbench::command_line {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::string pageNamed(const std::string& name) {
  for (const ManPage& page : manPages(sampleCommands(), "1.2")) {
    if (page.name == name) return page.text;
  }
  return {};
}

TEST(ManPages, AreThereForTheProgramAndEachCommand) {
  std::vector<std::string> names;
  for (const ManPage& page : manPages(sampleCommands(), "1.2")) names.push_back(page.name);
  EXPECT_THAT(names, ElementsAre("saw", "saw-cut", "saw-blade", "saw-blade-change", "saw-blade-sharpen"));
}

TEST(ManPages, LeaveOutACommandOfAnotherProgram) {
  CommandTree saw = sampleCommands();
  saw.commands[1].elsewhere = true;
  EXPECT_EQ(manPages(saw, "1.2").size(), 2U);
}

TEST(ManPages, HaveWhatManAndAproposLookFor) {
  const std::string page = pageNamed("saw-cut");
  EXPECT_THAT(page, HasSubstr(".TH SAW\\-CUT 1 \"\" \"Kerfbench 1.2\""));
  EXPECT_THAT(page, HasSubstr("saw\\-cut \\- cut boards\n"));
  EXPECT_THAT(page, HasSubstr(".B saw cut\n[\\fIOPTIONS\\fR] \\fIBOARD\\fR..."));
  EXPECT_THAT(page,
              HasSubstr("\\fB\\-b\\fR, \\fB\\-\\-blade\\fR \\fIcoarse|fine\\fR\nThe blade [default: fine]"));
  EXPECT_THAT(page, HasSubstr("How fast, in m/s"));
  EXPECT_THAT(page, HasSubstr("cut in the finger"));
}

TEST(ManPages, TellTheCommandsBelow) {
  EXPECT_THAT(pageNamed("saw"), HasSubstr("\\fBblade\\fR\nWhat is done to blades"));
}

// A line of text that begins so would be taken for a command of roff, and vanish.
TEST(ManPages, HaveNoLineOfTextThatRoffObeys) {
  CommandTree saw = sampleCommands();
  saw.help = ".bss is what it is";
  saw.commands.clear();
  EXPECT_THAT(manPages(saw, "1.2").front().text, HasSubstr("\n\\&.bss is what it is"));
  EXPECT_THAT(manPages(saw, "1.2").front().text, Not(HasSubstr("\n.bss")));
}

}  // namespace
}  // namespace kerfbench::command_line
