// SPDX-License-Identifier: Apache-2.0
#include "hil/fold/five_axis_program.h"

#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/input_error.h"

namespace kerfbench::fold {
namespace {

std::string programFaults(const std::string& text) {
  try {
    (void)readFiveAxisProgram(text, "p.gcode");
  } catch (const base::InputError& e) {
    return e.what();
  }
  return "";
}

constexpr const char* kStart = "G00 X1 Y2 Z3 A0 C0\n";

TEST(FiveAxisProgram, MovesHavePlacesAnglesAndBeam) {
  const auto moves = readFiveAxisProgram(
      "(a box) ; from kerfplan\nN1 G00 X-0.5 Y.25 Z1.0000 A0 C0\nG01 X2 (on) A90.0000 C-90\n\nY3\nG0 Z9\n",
      "p");
  ASSERT_EQ(moves.size(), 4U);
  EXPECT_FALSE(moves[0].cuts);
  EXPECT_EQ(moves[0].to.p_WQ_mm, Eigen::Vector3d(-0.5, 0.25, 1.0));
  EXPECT_TRUE(moves[1].cuts);
  EXPECT_NEAR(moves[1].to.a_rad, 0.5 * std::numbers::pi, 1e-12);
  EXPECT_NEAR(moves[1].to.c_rad, -0.5 * std::numbers::pi, 1e-12);
  // A line without G goes on, axes that are not named stay.
  EXPECT_TRUE(moves[2].cuts);
  EXPECT_EQ(moves[2].to.p_WQ_mm, Eigen::Vector3d(2.0, 3.0, 1.0));
  EXPECT_FALSE(moves[3].cuts);
}

TEST(FiveAxisProgram, EveryFaultIsToldWithItsLine) {
  const std::string faults = programFaults(std::string(kStart) +
                                           "G02 X1\nG01 X1 X2\nG01 F100\nG01 X1.2.3\nG01 Y\nG01 X99999\n"
                                           "G01 x3\nG01 Z1e5\nG01 (open\nG01 A400\n");
  EXPECT_THAT(faults, testing::HasSubstr("p.gcode:2: G2 is neither G00 nor G01"));
  EXPECT_THAT(faults, testing::HasSubstr("p.gcode:3: X comes twice"));
  EXPECT_THAT(faults, testing::HasSubstr("p.gcode:4: the letter F means nothing here"));
  EXPECT_THAT(faults, testing::HasSubstr("p.gcode:5: 'X1.2.3' is no word"));
  EXPECT_THAT(faults, testing::HasSubstr("p.gcode:6: 'Y' is no word"));
  EXPECT_THAT(faults, testing::HasSubstr("p.gcode:7: X99999 is out of"));
  EXPECT_THAT(faults, testing::HasSubstr("p.gcode:8: 'x3' is no word"));
  EXPECT_THAT(faults, testing::HasSubstr("p.gcode:9: "));
  EXPECT_THAT(faults, testing::HasSubstr("p.gcode:10: a bracket is not closed"));
  EXPECT_THAT(faults, testing::HasSubstr("p.gcode:11: A400 is out of"));
}

TEST(FiveAxisProgram, BeginsWithAWholePoseAndCutsSomething) {
  EXPECT_THAT(programFaults("G01 X1 Y2 Z3 A0 C0\n"), testing::HasSubstr("the first move must be a G00"));
  EXPECT_THAT(programFaults("G00 X1 Y2 Z3 A0\nG01 X2\n"), testing::HasSubstr("p.gcode:1: the first move"));
  EXPECT_THAT(programFaults("X1 Y2 Z3 A0 C0\n"), testing::HasSubstr("a move before the first G00"));
  EXPECT_THAT(programFaults(kStart), testing::HasSubstr("the program cuts nothing"));
  EXPECT_THAT(programFaults(""), testing::HasSubstr("the program cuts nothing"));
}

}  // namespace
}  // namespace kerfbench::fold
