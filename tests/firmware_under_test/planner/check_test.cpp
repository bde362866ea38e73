// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/program/check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/order/cut_twice.h"
#include "hil/dieline/geometry.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> twiceIn(const std::string& text) { return cutTwice(unitOf(readGcode(text))); }

TEST(Check, ListsFaultsOfEveryKindAtOnce) {
  MachineParameters machine = test::twoMirror();
  JobParameters job = test::mirrorJob();
  job.belt_speed_mm_s = 300.0;
  job.units = 3;
  job.pitch_mm = 5.0;
  machine.full_power_w = 20.0;
  const std::string text = "G00 X0 Y0\nG01 X-50 Y0 Z1\nG01 X-50 Y90\nG00 X0 Y0\nG01 X-50 Y0\n";
  const CheckResult checked = checkJob(text, machine, job);
  EXPECT_FALSE(checked.solution);
  EXPECT_THAT(checked.errors, Contains(HasSubstr("line 3 spans y")));
  EXPECT_THAT(checked.errors, Contains(HasSubstr("belt speed of 300 mm/s")));
  EXPECT_THAT(checked.errors, Contains(HasSubstr("the laser has 20 W")));
  EXPECT_THAT(checked.warnings, ElementsAre(HasSubstr("line 5: 50.000 mm of it are burnt by line 2")));
}

TEST(Check, FaultsOfParametersAndOfTextStandTogether) {
  MachineParameters machine = test::twoMirror();
  machine.throw_mm = -1.0;
  const CheckResult checked = checkJob("G00 X0 Y0\nG01 X1 Z2\n", machine, test::mirrorJob());
  EXPECT_THAT(checked.errors, Contains(HasSubstr("throw_mm")));
  EXPECT_THAT(checked.errors, Contains(HasSubstr("line 2: Z2 is outside")));
}

TEST(Check, MarksAndPitchAreBothNamed) {
  JobParameters job = test::mirrorJob();
  job.belt_speed_mm_s = 60.0;
  job.units = 20;
  job.pitch_mm = 0.5;
  const CheckResult checked = checkJob("G00 X0 Y0\nG01 X-1 Y0 Z1\n", test::twoMirror(), job);
  EXPECT_THAT(checked.errors,
              Contains(::testing::AllOf(HasSubstr("print marks"), HasSubstr("pitch of 0.5"))));
}

TEST(CutTwice, LinesThatShareAPart) {
  EXPECT_THAT(twiceIn("G0 X0 Y0\nG1 X10 Y5 Z1\nG0 X6 Y3\nG1 X2 Y1\n"),
              ElementsAre(HasSubstr("line 4: 4.472 mm")));
  EXPECT_THAT(twiceIn("G0 X0 Y0\nG1 X10 Z1\nG1 X20\nG0 X0 Y.02\nG1 X10\nG0 X5 Y-5\nG1 Y5\n"), IsEmpty());
}

TEST(CutTwice, ArcsThatShareAPart) {
  const std::string circle = "G0 X10 Y0\nG2 X10 Y0 I-10 J0 Z1\n";
  EXPECT_THAT(twiceIn(circle + "G0 X0 Y10\nG3 X-10 Y0 I0 J-10\n"), ElementsAre(HasSubstr("15.708 mm")));
  EXPECT_THAT(twiceIn("G0 X10 Y0\nG3 X0 Y10 I-10 J0 Z1\nG3 X-10 Y0 I0 J-10\nG3 X0 Y-10 I10 J0\n"), IsEmpty());
  // The border of an angle of +-pi lies within.
  EXPECT_THAT(twiceIn("G0 X0 Y10\nG3 X0 Y-10 I0 J-10 Z1\nG0 X-10 Y0\nG2 X0 Y10 I10 J0\n"),
              ElementsAre(HasSubstr("15.708 mm")));
}

TEST(CutTwice, NoDielineOfOursIs) {
  for (const dieline::Dieline& dieline : {test::label(), test::carton(), test::strip()}) {
    EXPECT_THAT(twiceIn(makeGcode(dieline, test::twoMirror(), test::mirrorJob())), IsEmpty());
  }
}

TEST(CutTwice, ManyMarksInTheSamePlaceTakeBoundedTime) {
  std::string text = "G0 X0 Y0 Z0\n";
  for (int i = 0; i < 20000; ++i) text += i % 2 == 0 ? "G1 X50 Y0 Z1\n" : "G1 X0 Y0 Z1\n";
  EXPECT_EQ(twiceIn(text).size(), 101U);
}

}  // namespace
}  // namespace kerfbench::planner
