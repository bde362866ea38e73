// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/gcode/gcode.h"

#include <cmath>
#include <numbers>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using test::carton;
using test::label;
using test::mirrorJob;
using test::twoMirror;
using ::testing::HasSubstr;

std::string gcodeFaults(const std::string& text) {
  try {
    readGcode(text);
  } catch (const PlanError& error) {
    return error.what();
  }
  return {};
}

std::string replaced(const std::string& text, const std::string& pattern, const std::string& by) {
  return std::regex_replace(text, std::regex(pattern), by);
}

std::vector<std::vector<Segment>> marksOf(const std::vector<Segment>& path) {
  std::vector<std::vector<Segment>> pieces;
  bool jumped = true;
  for (const Segment& segment : path) {
    if (!segment.jump && jumped) pieces.emplace_back();
    if (!segment.jump) pieces.back().push_back(segment);
    jumped = segment.jump;
  }
  return pieces;
}

TEST(Gcode, SaysWhatThePaperSays) {
  const std::string text = makeGcode(label(), twoMirror(), mirrorJob());
  EXPECT_THAT(text,
              HasSubstr("LINE\nG00 X0.0000 Y17.0000 Z0 (E6 cut)\nG01 X0.0000 Y-17.0000 Z1 (E6 cut)\nARC\n"
                        "G02 X-3.0000 Y-20.0000 I-3.0000 J0.0000 Z1 (E7 cut)\n"));
}

TEST(Gcode, WrittenReadAndWrittenAgainIsTheSame) {
  std::vector<std::string> names(64, "cut");
  for (const dieline::Dieline& dieline : {label(), carton(), test::strip()}) {
    const std::vector<Segment> path = readGcode(makeGcode(dieline, twoMirror(), mirrorJob()));
    const std::string once = writeGcode(marksOf(path), names);
    EXPECT_EQ(writeGcode(marksOf(readGcode(once)), names), once);
  }
}

TEST(Gcode, AFullCircleEndsWhereItBegins) {
  dieline::Dieline dieline = test::dielineOf({test::arc(-30, 5, 12, 40, -360)});
  const std::string text = makeGcode(dieline, twoMirror(), mirrorJob());
  EXPECT_THAT(text, HasSubstr("CIRCLE\n"));
  const std::vector<Segment> path = readGcode(text);
  ASSERT_EQ(path.size(), 1U);
  EXPECT_DOUBLE_EQ(path[0].sweep_rad, -2.0 * std::numbers::pi);
  EXPECT_NEAR(path[0].lengthMm(), 2.0 * std::numbers::pi * 12.0, 1e-3);
}

TEST(Gcode, HandEditsThatChangeNothingChangeNothing) {
  const MachineParameters machine = twoMirror();
  const std::string text = makeGcode(label(), machine, mirrorJob());
  const Program program = planFromGcode(text, machine, mirrorJob()).program;
  std::string lower = text;
  for (char& c : lower) c = static_cast<char>(std::tolower(c));
  const std::vector<std::string> edited{
      lower,
      replaced(text, "G0", "  G 0"),
      replaced(text, "X", " x "),
      replaced(text, "LINE\n|ARC\n", ""),
      replaced(text, "(G0[123])", "N10 $1"),
      replaced(text, "\n", " ; by hand\r\n"),
      "%\n(label) G21 G90\n\n" + text + "M30\nnothing that follows is read\n",
      replaced(text, " Z1", ""),
  };
  for (std::size_t i = 0; i + 1 < edited.size(); ++i) {
    EXPECT_EQ(planFromGcode(edited[i], machine, mirrorJob()).program.ops, program.ops) << edited[i];
  }
  EXPECT_THAT(gcodeFaults(edited.back()), HasSubstr("no Z yet"));
}

TEST(Gcode, WordsLeftOutKeepTheirValue) {
  const auto path = readGcode("g0x1y2\ng1x5z.5\ny7\ng0x0\ng1y0\n");
  ASSERT_EQ(path.size(), 4U);
  EXPECT_EQ(path[0].end_mm, Eigen::Vector2d(5, 2));
  EXPECT_EQ(path[1].end_mm, Eigen::Vector2d(5, 7));
  EXPECT_EQ(path[1].z, 0.5);
  EXPECT_TRUE(path[2].jump);
  EXPECT_EQ(path[2].end_mm, Eigen::Vector2d(0, 7));
  EXPECT_EQ(path[3].z, 0.5) << "a jump must not clear the Z of marks";
}

TEST(Gcode, DeletedAndReorderedGroupsAreCutAsTheyStand) {
  const auto path = readGcode(
      "LINE\nG00 X-30 Y0 Z0 (E2 cut)\nG01 X-20 Y0 Z1 (E2 cut)\nLINE\nG00 X0 Y0 Z0 (E0 cut)\nG01 X-10 Y0 Z1 "
      "(E0 cut)\n");
  ASSERT_EQ(path.size(), 3U);
  EXPECT_EQ(path[0].entity, 2);
  EXPECT_EQ(path[2].entity, 0);
  EXPECT_EQ(path[2].line, 6);
}

TEST(Gcode, EveryFaultIsListedWithItsLine) {
  const std::string faults = gcodeFaults(
      "G01 X1 Y1 Z1\n"               // 1 no start
      "G00 X0 Y0 Z0\n"               //
      "G02 X10 Y0 I4.99 J0 Z1\n"     // 3 off the circle by 0.02
      "G01 X1 Y1 Z1.5\n"             // 4 Z
      "G01 X1 Q7 Z1\n"               // 5 unknown
      "G17\n"                        // 6 unknown
      "G01 Xnan Y0\n"                // 7 no number
      "G01 X1e9 Y0\n"                // 8 E is no word
      "G03 X0 Y1\n"                  // 9 no I, J
      "G00 X3 Y3 Z1\n"               // 10 jump with laser on
      "G01 X1 X2\n"                  // 11 twice
      "G01 X (oh\n"                  // 12 open comment
      "G01 X99999999999999999 Y0\n"  // 13 out of bounds
      "*\n"                          // 14
      "G1 X4 I3\n"                   // 15
      "G02 X3 Y3 I0 J0\n");          // 16
  for (const int line : {1, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16}) {
    EXPECT_THAT(faults, HasSubstr("line " + std::to_string(line) + ":"));
  }
  EXPECT_THAT(faults, ::testing::Not(HasSubstr("line 2:")));
  EXPECT_THAT(faults, HasSubstr("0.0200 mm off its circle"));
}

TEST(Gcode, AnArcWithinFiveMicrometresIsTaken) {
  EXPECT_EQ(gcodeFaults("G00 X0 Y0\nG02 X10 Y0 I5.002 J0 Z1\n"), "");
  EXPECT_THAT(gcodeFaults("G00 X0 Y0\nG02 X10 Y0 I5.003 J0 Z1\n"), HasSubstr("line 2"));
}

TEST(Gcode, NothingToCutIsAFault) {
  EXPECT_THAT(gcodeFaults(""), HasSubstr("no line or arc"));
  EXPECT_THAT(gcodeFaults("G00 X1 Y1\nG00 X2 Y2\n"), HasSubstr("no line or arc"));
}

TEST(Gcode, NeverCrashesOnDamage) {
  const std::string text = makeGcode(carton(), twoMirror(), mirrorJob());
  std::uint32_t state = 12345;
  for (int round = 0; round < 300; ++round) {
    std::string damaged = text.substr(0, 600);
    for (int i = 0; i < 6; ++i) {
      state = state * 1664525U + 1013904223U;
      damaged[(state >> 8) % damaged.size()] = static_cast<char>((state >> 20) & 0xFF);
    }
    try {
      for (const Segment& segment : readGcode(damaged)) {
        ASSERT_TRUE(segment.at(0.5 * segment.lengthMm()).allFinite());
        ASSERT_GE(segment.z, 0.0);
        ASSERT_LE(segment.z, 1.0);
      }
    } catch (const PlanError&) {
    }
  }
}

}  // namespace
}  // namespace kerfbench::planner
