// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using test::play;
using test::Played;

dieline::Dieline fixture(const std::string& name) {
  return dieline::readDieline(std::string(KERFBENCH_SOURCE_DIR) + "/fixtures/dielines/" + name,
                              dieline::defaultLayerProfile());
}

void expectCut(const dieline::Dieline& dieline, const MachineParameters& machine, const JobParameters& job) {
  const Plan plan = planner::plan(dieline, machine, job);
  const Played played = play(plan.program, machine, job);
  EXPECT_EQ(played.error, "");
  EXPECT_LT(test::worstDeviationMm(played, dieline, job), 0.015);
  EXPECT_LT(test::worstGapMm(played, dieline, job, 0), 0.015);
}

TEST(Fixtures, LabelAtRestAndOnTheBelt) {
  JobParameters job = test::mirrorJob();
  for (const double belt : {0.0, 100.0, 150.0}) {
    job.belt_speed_mm_s = belt;
    expectCut(fixture("label-60x40.dxf"), test::twoMirror(), job);
  }
}

TEST(Fixtures, LabelDrawnInTwoFormatsIsTheSameCut) {
  const JobParameters job = test::mirrorJob();
  const Plan dxf = planner::plan(fixture("label-60x40.dxf"), test::twoMirror(), job);
  const Plan svg = planner::plan(fixture("label-60x40.svg"), test::twoMirror(), job);
  EXPECT_NEAR(dxf.cut_length_mm, svg.cut_length_mm, 0.01 * dxf.cut_length_mm);
}

TEST(Fixtures, CartonOnTheBeltAndOnTheGantry) {
  JobParameters job = test::mirrorJob();
  job.belt_speed_mm_s = 5.0;
  expectCut(fixture("tuck-end-carton.dxf"), test::twoMirror(), job);
  JobParameters slow = test::gantryJob();
  slow.belt_speed_mm_s = 20.0;
  expectCut(fixture("tuck-end-carton.dxf"), test::gantry(), slow);
  slow.belt_speed_mm_s = 0.0;
  slow.web_start_x_mm = 400.0;
  expectCut(fixture("tuck-end-carton.dxf"), test::gantry(), slow);
}

TEST(Fixtures, StripAtThePapersSpeeds) {
  JobParameters job = test::gantryJob();
  job.belt_speed_mm_s = 200.0;
  expectCut(fixture("strip-crosscut.dxf"), test::gantry(), job);
}

}  // namespace
}  // namespace kerfbench::planner
