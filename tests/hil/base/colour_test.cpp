// SPDX-License-Identifier: Apache-2.0
#include "hil/base/colour.h"

#include <cstdio>
#include <string>

#include <gtest/gtest.h>

namespace kerfbench::base {
namespace {

class ColourTest : public testing::Test {
 protected:
  void TearDown() override { chooseColour(ColourChoice::kAuto); }
};

TEST_F(ColourTest, IsNotInWhatIsNoTerminal) {
  std::FILE* file = std::tmpfile();
  ASSERT_NE(file, nullptr);
  EXPECT_EQ(inColour("PASS", Colour::kGreen, file), "PASS");
  EXPECT_EQ(withVerdictsInColour("  FAIL  path", file), "  FAIL  path");
  std::fclose(file);
}

TEST_F(ColourTest, IsWhatTheUserWants) {
  chooseColour(ColourChoice::kAlways);
  EXPECT_EQ(inColour("x", Colour::kRed, stdout), "\x1b[31mx\x1b[0m");
  chooseColour(ColourChoice::kNever);
  EXPECT_EQ(inColour("x", Colour::kRed, stdout), "x");
}

TEST_F(ColourTest, IsThatOfAVerdictAndOfNoOtherWord) {
  chooseColour(ColourChoice::kAlways);
  EXPECT_EQ(withVerdictsInColour("plate: PASS", stdout), "plate: \x1b[32mPASS\x1b[0m");
  EXPECT_EQ(withVerdictsInColour("plate: NOT PROVEN, 3", stdout), "plate: \x1b[33mNOT PROVEN\x1b[0m, 3");
  EXPECT_EQ(withVerdictsInColour("BYPASS PASSED FAILURE", stdout), "BYPASS PASSED FAILURE");
  EXPECT_EQ(withVerdictsInColour("", stdout), "");
}

}  // namespace
}  // namespace kerfbench::base
