// SPDX-License-Identifier: Apache-2.0
// Jumps for which arcs are wished: they have them, and where they have not, the reason is told.
#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/motion/solve.h"
#include "hil/dieline/read.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

UnitPath planned(const std::vector<Segment>& path, double radius_mm, const std::vector<bool>& stops = {}) {
  JobParameters job = test::mirrorJob();
  job.jump_radius_mm = radius_mm;
  const auto unit = planUnit(path, job, Axes(test::twoMirror(), {}), 0.0, stops);
  EXPECT_TRUE(unit);
  return unit.value_or(UnitPath{});
}

std::size_t jumpsOf(const std::vector<Segment>& path) {
  return static_cast<std::size_t>(
      std::count_if(path.begin(), path.end(), [](const Segment& segment) { return segment.jump; }));
}

const std::vector<Segment>& buttonPath() {
  static const std::vector<Segment> path = [] {
    const dieline::Dieline drawing = dieline::readDieline(
        std::string(KERFBENCH_SOURCE_DIR) + "/fixtures/dielines/button.dxf", dieline::defaultLayerProfile());
    std::vector<Segment> read = readGcode(makeGcode(drawing, test::twoMirror(), test::mirrorJob()));
    while (read.front().jump) read.erase(read.begin());
    return read;
  }();
  return path;
}

TEST(JumpsTaken, WhoAsksForArcsGetsThem) {
  const std::vector<Segment>& path = buttonPath();
  for (const double radius_mm : {0.3, 1.0, 3.0, 5.0, kRadiusOfDrawing}) {
    const UnitPath unit = planned(path, radius_mm);
    EXPECT_EQ(static_cast<std::size_t>(unit.jumps.smooth), jumpsOf(path)) << radius_mm;
    EXPECT_TRUE(unit.jumps.straight.empty()) << radius_mm;
    EXPECT_EQ(unit.blocks.size(), 1U) << "no jump rests";
  }
  EXPECT_EQ(planned(path, 0.0).jumps.smooth, 0);
}

TEST(JumpsTaken, AHeldJumpIsNamed) {
  const std::vector<Segment>& path = buttonPath();
  std::vector<bool> stops(7, false);
  stops[3] = stops[6] = true;
  const UnitPath unit = planned(path, 3.0, stops);
  ASSERT_EQ(unit.jumps.straight.size(), 2U);
  EXPECT_EQ(static_cast<std::size_t>(unit.jumps.smooth), jumpsOf(path) - 2);
  std::size_t jump = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    if (!path[i - 1].jump || path[i].jump) continue;
    if (jump++ != 3) continue;
    EXPECT_EQ(unit.jumps.straight[0].entity, path[i].entity);
    EXPECT_EQ(unit.jumps.straight[0].line, path[i].line);
    EXPECT_EQ(unit.jumps.straight[0].why, JumpsTaken::Why::kWaits);
  }
}

TEST(JumpsTaken, ArcsThatWouldLeaveTheFieldAreNotTaken) {
  // Up to 0.1 mm from the field's end, and on from there: every arc of 1 mm or more swings over it. The field
  // ends at 80 mm on all sides.
  for (const bool across : {true, false}) {
    const std::string to = across ? "G01 X10 Y79.9 Z1\n" : "G01 X79.9 Y10 Z1\n";
    const std::string other =
        across ? "G00 X40 Y79.9 Z0\nG01 X40 Y70 Z1\n" : "G00 X79.9 Y40 Z0\nG01 X70 Y40 Z1\n";
    std::vector<Segment> path =
        readGcode(std::string(across ? "G00 X10 Y70 Z0\n" : "G00 X70 Y10 Z0\n") + to + other);
    while (path.front().jump) path.erase(path.begin());
    const UnitPath wide = planned(path, 8.0);
    ASSERT_EQ(wide.jumps.straight.size(), 1U) << across;
    EXPECT_EQ(wide.jumps.straight[0].why, JumpsTaken::Why::kField);
    EXPECT_EQ(planned(path, 0.1).jumps.smooth, 1) << "small arcs fit";
  }
}

TEST(JumpsTaken, ASheetThatMustBeWaitedForSaysSo) {
  // Marks 140 mm apart: the third is still upstream of the field when the second is done.
  std::vector<Segment> path = readGcode(
      "G00 X0 Y0 Z0\nG01 X0 Y20 Z1\nG00 X-140 Y0 Z0\nG01 X-140 Y20 Z1\nG00 X-280 Y0 Z0\nG01 X-280 Y20 Z1\n");
  while (path.front().jump) path.erase(path.begin());
  JobParameters job = test::mirrorJob();
  job.jump_radius_mm = 2.0;
  const MachineParameters machine = test::twoMirror();
  const SolveResult result = solve(path, machine, job, Axes(machine, {}), 20.0);
  ASSERT_TRUE(result.solution) << result.reason;
  const JumpsTaken& jumps = result.solution->paths.front().jumps;
  ASSERT_FALSE(jumps.straight.empty());
  for (const JumpsTaken::Straight& jump : jumps.straight) EXPECT_EQ(jump.why, JumpsTaken::Why::kWaits);
  EXPECT_EQ(jumps.straight.back().line, 6);
  EXPECT_EQ(static_cast<std::size_t>(jumps.smooth) + jumps.straight.size(), 2U);
}

}  // namespace
}  // namespace kerfbench::planner
