// SPDX-License-Identifier: Apache-2.0
#include "hil/app/case.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/yaml_reader.h"
#include "tests/hil/app/temp_folder.h"

namespace kerfbench::hil {
namespace {

using testing::HasSubstr;

class CaseTest : public testing::Test {
 protected:
  void SetUp() override { (void)temp_.write("controller-avr.hex", ":00000001FF\n"); }
  Case label(const std::string& lines) const {
    const auto path = temp_.write("s.yaml", "extends: " + fixture("scenarios/label-on-belt.yaml").string() +
                                                "\nname: changed\n" + lines);
    return readCase(path, temp_.path());
  }
  std::string faultsOf(const std::string& lines) const {
    try {
      label(lines);
    } catch (const ConfigError& e) {
      return e.what();
    }
    return {};
  }
  const TempFolder temp_;
};

TEST_F(CaseTest, TheFirstEyeMarkReachesItsSensorAfterTheLeadTime) {
  const Case the_case = label("belt: {lead_s: 0.7}\n");
  const twin::WebDescription web = webOf(the_case);
  const double mark_mm = web.start_x_mm + web.print.eye_mark_x_mm + 0.7 * web.belt_speed_mm_s;
  EXPECT_NEAR(mark_mm, the_case.machine.belt.print_mark_sensor.x_mm, 1e-9);
  EXPECT_EQ(plannerJob(the_case).web_start_x_mm, web.start_x_mm);
}

TEST_F(CaseTest, ThePlannerIsToldTheDataSheetAndNotTheTruth) {
  Case the_case = label("");
  the_case.machine.head.throw_mm = 512.0;
  the_case.machine.belt.encoder.count_mm = 0.02;
  EXPECT_EQ(plannerMachine(the_case).throw_mm, 500.0);
  EXPECT_EQ(plannerMachine(the_case).encoder_count_mm, 0.01);
}

TEST_F(CaseTest, TheMachineSetsTheRadiusOfJumpsAndTheScenarioWins) {
  const auto path =
      temp_.write("slow.yaml", "extends: " + fixture("machines/two-mirror-slow.yaml").string() + "\n");
  const std::string slow = "machine: " + path.string() + "\n";
  EXPECT_EQ(plannerJob(label("")).jump_radius_mm, 0.0);
  EXPECT_EQ(plannerJob(label(slow)).jump_radius_mm, 5.0);
  EXPECT_EQ(plannerMachine(label(slow)).mirror_acceleration_rad_s2, 9.0);
  EXPECT_EQ(plannerJob(label(slow + "planner: {jump_radius_mm: 0}\n")).jump_radius_mm, 0.0);
  EXPECT_EQ(plannerJob(label("planner: {jump_radius_mm: -1}\n")).jump_radius_mm, planner::kRadiusOfDrawing);
  EXPECT_EQ(plannerJob(label("planner: {jump_acceleration_mm_s2: 5000}\n")).jump_acceleration_mm_s2, 5000.0);
  EXPECT_THAT(faultsOf("planner: {jump_radius_mm: -0.5}\n"),
              HasSubstr("planner.jump_radius_mm: is a radius"));
}

TEST_F(CaseTest, AMachineWithoutAFeedDriveCannotFeed) {
  const auto path = temp_.write(
      "no-feed.yaml", "extends: " + fixture("machines/two-mirror.yaml").string() + "\nbelt: {feed: ~}\n");
  const std::string lines = "machine: " + path.string() + "\n";
  EXPECT_EQ(faultsOf(lines), "");
  EXPECT_THAT(faultsOf(lines + "belt: {drive: controller}\n"), HasSubstr("feed"));
}

TEST_F(CaseTest, ALineMayChangeItsSpeed) {
  const Case the_case = label("belt: {profile: [{at_s: 1.0, speed_mm_s: 70}, {at_s: 2.5, speed_mm_s: 0}]}\n");
  const twin::WebDescription web = webOf(the_case);
  ASSERT_EQ(web.belt_speed_changes.size(), 2U);
  EXPECT_EQ(web.belt_speed_changes[1].time_s, 2.5);
  EXPECT_EQ(web.belt_speed_changes[0].speed_mm_s, 70.0);
  EXPECT_EQ(web.belt_speed_mm_s, 60.0);
  EXPECT_THAT(faultsOf("belt: {profile: [{at_s: 2, speed_mm_s: 70}, {at_s: 1, speed_mm_s: 0}]}\n"),
              HasSubstr("at_s: must be later than the point before"));
  EXPECT_THAT(faultsOf("belt: {profile: wild}\n"), HasSubstr("belt.profile: 'wild' is none of: constant"));
  EXPECT_THAT(faultsOf("belt: {drive: controller, profile: [{at_s: 2, speed_mm_s: 70}]}\n"),
              HasSubstr("belt.profile: is the line's"));
}

TEST_F(CaseTest, ABoardMayHaveADepthCurveAndScorch) {
  const Case the_case = label(
      "board: {depth_curve: [{fluence_share: 0.2, depth_share: 0}, {fluence_share: 1, depth_share: 1}], "
      "scorch: {fluence_j_mm2: 0.3, darkening: 0.2, shift_mm: [0.05, 0]}}\n");
  const twin::BoardDescription board = webOf(the_case).board;
  ASSERT_EQ(board.depth_curve.size(), 2U);
  EXPECT_EQ(board.depth_curve[0].fluence_share, 0.2);
  EXPECT_EQ(board.scorch.fluence_j_mm2, 0.3);
  EXPECT_EQ(board.scorch.shift_mm[0], 0.05);
  EXPECT_THAT(faultsOf("board: {depth_curve: [{fluence_share: 1, depth_share: 1}]}\n"),
              HasSubstr("board.depth_curve: must go from depth_share 0"));
}

TEST_F(CaseTest, AMachineIsDrawnAroundItsDescriptionByPresetAndSeed) {
  const auto drawn = [&](const char* lines) { return drawnMachine(label(lines)); };
  EXPECT_TRUE(drawn("").imperfections.empty());
  const auto one = drawn("imperfections: dynamic\nseed: 7\n");
  const auto again = drawn("imperfections: dynamic\nseed: 7\n");
  const auto other = drawn("imperfections: dynamic\nseed: 8\n");
  ASSERT_FALSE(one.imperfections.empty());
  ASSERT_EQ(one.imperfections.size(), again.imperfections.size());
  EXPECT_EQ(one.imperfections[0].value, again.imperfections[0].value);
  EXPECT_NE(one.imperfections[0].value, other.imperfections[0].value);
  // What the controller is told stays what it was.
  EXPECT_EQ(one.machine.controller.encoder_count_mm, 0.01);
  EXPECT_NE(one.machine.belt.encoder.count_mm, 0.01);
  EXPECT_GT(one.imperfections.size(), drawn("imperfections: static\nseed: 7\n").imperfections.size());
  EXPECT_THAT(faultsOf("imperfections: some\n"), HasSubstr("'some' is none of: ideal, static, dynamic"));
  EXPECT_THAT(faultsOf("twin: slow\n"), HasSubstr("'slow' is none of: reference, fast"));
}

TEST_F(CaseTest, AMachineThatTheTwinCannotRunIsRefusedWithItsLine) {
  const auto path = temp_.write("weak.yaml", "extends: " + fixture("machines/two-mirror.yaml").string() +
                                                 "\ngalvo_x: {friction: {coulomb_n_m: 1}}\n");
  EXPECT_THAT(faultsOf("machine: " + path.string() + "\n"), HasSubstr("weak.yaml:2: galvo_x: "));
}

TEST_F(CaseTest, EyeMarksThatOverlapAreAFault) {
  EXPECT_THAT(faultsOf("print: {eye_mark_length_mm: 70}\n"), HasSubstr("print.eye_mark_length_mm"));
}

}  // namespace
}  // namespace kerfbench::hil
