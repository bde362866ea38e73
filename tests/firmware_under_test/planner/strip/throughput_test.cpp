// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/strip/throughput.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/firmware_under_test/planner/player.h"

namespace kerfbench::planner {
namespace {

using ::testing::HasSubstr;

TEST(Throughput, TheTableHoldsThePapersFiguresAndTheRamps) {
  const std::string table = throughputTable(test::paperCut(), test::gantry(), test::gantryJob());
  for (const char* figure : {"9.5 /", "947.8 /", "94782.6 /", "603.5 /", "6003.5 /", "60003.5 /",
                             "695.7 of 780 mm", "221.9 / 205.8 mm/s"})
    EXPECT_THAT(table, HasSubstr(figure)) << table;
}

TEST(Throughput, TheHighestPlannedFeedIsNotRefused) {
  CrossCut cut = test::paperCut();
  const double highest = throughputOf(cut, test::gantry(), test::gantryJob()).planned_highest_mm_s;
  EXPECT_LT(highest, cut.highestFeedMm_s());
  cut.feed_mm_s = highest;
  EXPECT_NO_THROW(throughputOf(cut, test::gantry(), test::gantryJob()));
  cut.feed_mm_s = 1.001 * highest;
  EXPECT_THAT(test::refusal([&] { throughputOf(cut, test::gantry(), test::gantryJob()); }),
              HasSubstr("with ramps 205.8 mm/s at most can be planned"));
}

TEST(Throughput, ALateReturnIsRefused) {
  CrossCut late = test::paperCut();
  late.reposition_mm_s = 200.0;
  EXPECT_THAT(test::refusal([&] { throughputOf(late, test::gantry(), test::gantryJob()); }),
              HasSubstr("a piece has 1200 mm"));
}

}  // namespace
}  // namespace kerfbench::planner
