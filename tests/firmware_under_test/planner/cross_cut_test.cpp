// SPDX-License-Identifier: Apache-2.0
// Figures of the example of Hu, Hu, Jiang 2014, and a test that the formulas bound the planner's results.
#include "firmware_under_test/planner/program/cross_cut.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/planner/program/plan.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(CrossCut, ThePapersTimes) {
  const CrossCut cut = test::paperCut();
  EXPECT_THAT(cut.faults(), IsEmpty());
  EXPECT_NEAR(cut.carriedMm(), 695.7, 0.05);
  for (const double n : {100.0, 1000.0, 10000.0}) {
    EXPECT_NEAR(cut.stopAndGoS(n), 9.5 * n, 0.0025 * 9.5 * n);
    EXPECT_NEAR(cut.continuousS(n), 3.5 + 6.0 * n, 0.03);
  }
}

TEST(CrossCut, TheReturnMustMakeThePapersSpeed) {
  CrossCut cut = test::paperCut();
  cut.reposition_mm_s = 275.9;
  EXPECT_THAT(cut.faults(), IsEmpty());
  cut.reposition_mm_s = 275.8;
  ASSERT_EQ(cut.faults().size(), 1U);
  EXPECT_THAT(cut.faults()[0], HasSubstr("a piece has 1200 mm"));
}

TEST(CrossCut, TheHighestFeedIsWhereAConstraintIsReached) {
  for (const double reach_mm : {300.0, 780.0, 5000.0}) {
    for (const double back_mm_s : {150.0, 400.0, 3000.0}) {
      CrossCut cut = test::paperCut();
      cut.reach_mm = reach_mm;
      cut.reposition_mm_s = back_mm_s;
      const double highest = cut.highestFeedMm_s();
      cut.feed_mm_s = 0.9999 * highest;
      EXPECT_THAT(cut.faults(), IsEmpty());
      cut.feed_mm_s = 1.0001 * highest;
      EXPECT_EQ(cut.faults().size(), 1U);
    }
  }
}

TEST(CrossCut, NonsenseIsNamedAllAtOnce) {
  CrossCut cut = test::paperCut();
  cut.width_mm = 0.0;
  cut.cut_mm_s = -1.0;
  EXPECT_EQ(cut.faults().size(), 2U);
}

TEST(CrossCut, ThePlannerNeverBeatsTheFormulas) {
  JobParameters job = test::gantryJob();
  job.units = 4;
  job.pitch_mm = 1200.0;
  job.alternate = true;
  for (const double back_mm_s : {276.0, 400.0}) {
    job.jump_speed_mm_s = back_mm_s;
    job.belt_speed_mm_s = 100.0;
    CrossCut cut = test::paperCut();
    cut.reposition_mm_s = back_mm_s;
    const double planned = planner::plan(test::strip(), test::gantry(), job).max_belt_speed_mm_s;
    EXPECT_LE(planned, cut.highestFeedMm_s());
    EXPECT_GT(planned, 0.9 * cut.highestFeedMm_s()) << "ramps and catching up cost a few percent";
  }
}

TEST(CrossCut, ARefusalGivesTheNumbers) {
  JobParameters job = test::gantryJob();
  job.units = 4;
  job.pitch_mm = 1200.0;
  job.alternate = true;
  job.belt_speed_mm_s = 260.0;
  job.jump_speed_mm_s = 275.9;
  try {
    planner::plan(test::strip(), test::gantry(), job);
    FAIL() << "260 mm/s cannot be done";
  } catch (const PlanError& error) {
    EXPECT_THAT(error.what(), HasSubstr("904.3 mm while it cuts 800 mm at 230 mm/s"));
    EXPECT_THAT(error.what(), HasSubstr("224.2 mm/s at most"));
    EXPECT_THAT(error.what(), HasSubstr("a piece has 1200 mm: 200.0 mm/s at most"));
    EXPECT_THAT(error.what(), HasSubstr("the highest for this job is 188"));
  }
}

TEST(CrossCut, OnlyAStraightCutAcrossIsOne) {
  JobParameters job = test::gantryJob();
  job.units = 2;
  job.pitch_mm = 1200.0;
  job.belt_speed_mm_s = 200.0;
  Segment across;
  across.end_mm = {0.0, 800.0};
  EXPECT_TRUE(crossCutOf({across}, test::gantry(), job));
  EXPECT_FALSE(crossCutOf({across, across}, test::gantry(), job));
  across.end_mm.x() = 20.0;
  EXPECT_FALSE(crossCutOf({across}, test::gantry(), job));
}

}  // namespace
}  // namespace kerfbench::planner
