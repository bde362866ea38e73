// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/program/selection.h"

#include <algorithm>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "hil/dieline/geometry.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using dieline::Process;
using test::refusal;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

std::set<int> cutIn(const std::string& gcode) {
  std::set<int> ids;
  for (const Segment& segment : readGcode(gcode)) {
    if (!segment.jump && segment.z > 0.0) ids.insert(segment.entity);
  }
  return ids;
}

double markedMm(const std::string& gcode) {
  double sum = 0.0;
  for (const Segment& segment : readGcode(gcode)) sum += segment.jump ? 0.0 : segment.lengthMm();
  return sum;
}

std::string cartonGcode() { return makeGcode(test::carton(), test::twoMirror(), test::mirrorJob()); }

TEST(Selection, OfADrawingIgnoresTheRest) {
  dieline::Dieline dieline = test::carton();
  for (dieline::Entity& entity : dieline.entities) entity.layer = entity.id < 11 ? "CUT" : "Inner";
  dieline::Dieline chosen = dieline;
  select(chosen, selectionFrom("0, E5-e7", "", ""));
  EXPECT_THAT(cutIn(makeGcode(chosen, test::twoMirror(), test::mirrorJob())),
              UnorderedElementsAre(0, 5, 6, 7));
  chosen = dieline;
  select(chosen, selectionFrom("", "inner", "crease,Half-Cut"));
  EXPECT_THAT(cutIn(makeGcode(chosen, test::twoMirror(), test::mirrorJob())),
              UnorderedElementsAre(13, 14, 15));
}

TEST(Selection, OfGcodeIsThatOfTheDrawing) {
  for (const auto& [entities, processes] :
       {std::pair("0-10", ""), std::pair("11,13-16", ""), std::pair("", "crease"),
        std::pair("12-16", "cut,perforation"), std::pair("", "half-cut")}) {
    dieline::Dieline dieline = test::carton();
    const Selection selection = selectionFrom(entities, "", processes);
    const std::string chosen = select(cartonGcode(), selection);
    select(dieline, selection);
    const std::string drawn = makeGcode(dieline, test::twoMirror(), test::mirrorJob());
    EXPECT_EQ(cutIn(chosen), cutIn(drawn)) << entities << processes;
    EXPECT_NEAR(markedMm(chosen), markedMm(drawn), 1e-2) << entities << processes;
    EXPECT_EQ(select(chosen, selection), chosen) << "once more changes nothing";
  }
}

TEST(Selection, NothingChosenByWordsIsEverything) {
  EXPECT_TRUE(selectionFrom("", " ", "").all());
  EXPECT_EQ(select(cartonGcode(), Selection{}), cartonGcode());
}

TEST(Selection, WordsThatMakeNoSenseAreListed) {
  EXPECT_THAT(refusal([] { selectionFrom("3,x,8-5,-2,99999999999", "a,,b", "cut,burn"); }),
              AllOf(HasSubstr("'x' is neither"), HasSubstr("'8-5' ends before"), HasSubstr("'-2' is neither"),
                    HasSubstr("'99999999999'"), HasSubstr("layers: a name is missing"),
                    HasSubstr("'burn' is none of")));
}

TEST(Selection, WhatIsNotThereIsRefused) {
  dieline::Dieline dieline = test::carton();
  EXPECT_THAT(refusal([&] { select(dieline, selectionFrom("3,40-50", "Lid", "")); }),
              AllOf(HasSubstr("E40-E50: there is no such entity; the ids go from 0 to 16"),
                    HasSubstr("lid: there is no such layer")));
  dieline = test::carton();
  EXPECT_THAT(refusal([&] { select(dieline, selectionFrom("0-3", "", "crease")); }),
              HasSubstr("nothing is chosen"));
  EXPECT_THAT(refusal([&] { select(cartonGcode(), selectionFrom("17", "", "")); }),
              HasSubstr("E17: there is no such"));
  EXPECT_THAT(refusal([&] { select(cartonGcode(), selectionFrom("", "cut", "")); }),
              HasSubstr("layers cannot be chosen"));
  EXPECT_THAT(refusal([&] { select("G0 X0 Y0\nG1 X1 Z1\n", selectionFrom("0", "", "")); }),
              HasSubstr("belongs to an entity"));
  EXPECT_THAT(refusal([&] { select("G0 X0 Y0\nG1 X1 Z7\n", selectionFrom("0", "", "")); }),
              HasSubstr("line 2: Z7"));
}

TEST(Selection, AnIdOfAnySizeIsOnlyANumber) {
  const std::string text = "G0 X0 Y0\nG1 X-5 Z1 (E2147483647 cut)\n";
  EXPECT_THAT(cutIn(select(text, selectionFrom("2147483647", "", ""))), ElementsAre(2147483647));
}

// Groups of lines between two headings, as a user with an editor moves them.
std::vector<std::string> groupsOf(const std::string& gcode) {
  std::vector<std::string> groups;
  std::istringstream lines(gcode);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("G00") != std::string::npos) groups.emplace_back();
    if (!groups.empty() && line.find('G') == 0) groups.back() += line + "\n";
  }
  return groups;
}

TEST(HandEdits, GroupsInAnotherOrderCutTheSame) {
  std::vector<std::string> groups = groupsOf(cartonGcode());
  ASSERT_GT(groups.size(), 4U);
  std::reverse(groups.begin(), groups.end());
  std::rotate(groups.begin(), groups.begin() + 2, groups.end());
  std::string text;
  for (const std::string& group : groups) text += group;
  JobParameters job = test::mirrorJob();
  job.web_start_x_mm = 70.0;
  MachineParameters machine = test::twoMirror();
  const Plan plan = planFromGcode(text, machine, job);
  const test::Played played = test::play(plan.program, machine, job);
  EXPECT_LT(test::worstDeviationMm(played, test::carton(), job), 0.015);
  EXPECT_LT(test::worstGapMm(played, test::carton(), job, 0), 0.015);
}

TEST(HandEdits, AChangedLineIsCutWhereItIsSaidNow) {
  const std::string text = "G00 X-10 Y0\nG01 X-10 Y30 Z1 (E0 cut)\nG01 X-40 Y30 (E1 cut)\n";
  const Plan plan = planFromGcode(text, test::twoMirror(), test::mirrorJob());
  const auto now = test::dielineOf({test::line(-10, 0, -10, 30), test::line(-10, 30, -40, 30)});
  const test::Played played = test::play(plan.program, test::twoMirror(), test::mirrorJob());
  EXPECT_LT(test::worstDeviationMm(played, now, test::mirrorJob()), 0.015);
  EXPECT_LT(test::worstGapMm(played, now, test::mirrorJob(), 0), 0.015);
}

}  // namespace
}  // namespace kerfbench::planner
