// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/order/cut_order.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "firmware_under_test/planner/order/chains.h"
#include "hil/dieline/geometry.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using dieline::Process;
using Pieces = std::vector<std::vector<Segment>>;

Pieces order(const dieline::Dieline& dieline, double belt, const OrderOptions& options = {},
             const PlannerFaults& faults = {}) {
  JobParameters job = test::mirrorJob();
  job.belt_speed_mm_s = belt;
  return cutOrder(dieline, job, faults, options);
}

int firstOf(const Pieces& pieces, int entity) {
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    for (const Segment& segment : pieces[i]) {
      if (segment.entity == entity) return static_cast<int>(i);
    }
  }
  return -1;
}

double lengthOf(const Pieces& pieces, int entity = -1) {
  double sum = 0.0;
  for (const auto& piece : pieces) {
    for (const Segment& segment : piece)
      sum += entity < 0 || segment.entity == entity ? segment.lengthMm() : 0.0;
  }
  return sum;
}

TEST(CutOrder, ConnectedEntitiesAreOnePiece) {
  const Pieces pieces = order(test::label(), 0.0);
  ASSERT_EQ(pieces.size(), 1U);
  EXPECT_EQ(pieces[0].size(), 8U);
  for (std::size_t i = 1; i < 8; ++i) EXPECT_LT(turnRad(pieces[0][i - 1], pieces[0][i]), 1e-6);
}

TEST(CutOrder, EntitiesDrawnAnyWayRoundAreJoined) {
  dieline::Dieline dieline = test::label();
  std::swap(dieline.entities[1].curve, dieline.entities[6].curve);
  dieline.entities[2].curve = dieline::reversed(dieline.entities[2].curve);
  dieline.entities[5].curve = dieline::reversed(dieline.entities[5].curve);
  EXPECT_EQ(order(dieline, 0.0).size(), 1U);
}

TEST(CutOrder, CreasesThenHolesThenOutline) {
  for (const double belt : {0.0, 5.0}) {
    const Pieces pieces = order(test::carton(), belt);
    const int window = firstOf(pieces, 11);
    const int outline = firstOf(pieces, 0);
    for (const int crease : {13, 14, 15, 16}) EXPECT_LT(firstOf(pieces, crease), window);
    EXPECT_LT(window, outline);
    EXPECT_LT(firstOf(pieces, 12), outline) << "a slot is a hole too";
    EXPECT_EQ(outline, static_cast<int>(pieces.size()) - 1);
  }
}

TEST(CutOrder, OnAMovingSheetWhatLeavesFirstIsCutFirst) {
  const dieline::Dieline dieline =
      test::dielineOf({test::line(-100, 0, -90, 0), test::line(0, 50, -10, 50), test::line(-50, 0, -40, 0),
                       test::line(-20, -40, -30, -40)});
  const Pieces pieces = order(dieline, 100.0);
  EXPECT_EQ(firstOf(pieces, 1), 0);
  EXPECT_EQ(firstOf(pieces, 3), 1);
  EXPECT_EQ(firstOf(pieces, 2), 2);
  EXPECT_EQ(firstOf(pieces, 0), 3);
  for (const auto& piece : pieces) EXPECT_GT(piece.front().start_mm.x(), piece.back().end_mm.x());
}

TEST(CutOrder, BreakingLosesAndDoublesNothing) {
  const dieline::Dieline dieline = test::carton();
  const double whole = lengthOf(order(dieline, 50.0));
  for (const bool place : {false, true}) {
    const Pieces broken = order(dieline, 50.0, {true, place, 15.0});
    EXPECT_GT(broken.size(), order(dieline, 50.0).size());
    EXPECT_NEAR(lengthOf(broken), whole, 1e-9);
  }
}

TEST(CutOrder, ASkippedEntityIsMissingAndARepeatedOneComesTwice) {
  const dieline::Dieline dieline = test::carton();
  PlannerFaults faults;
  faults.skip_entity = 4;
  EXPECT_EQ(firstOf(order(dieline, 0.0, {}, faults), 4), -1);
  EXPECT_NEAR(lengthOf(order(dieline, 0.0, {}, faults)),
              lengthOf(order(dieline, 0.0)) - lengthOf(order(dieline, 0.0), 4), 1e-9);
  faults = {};
  faults.repeat_entity = 11;
  EXPECT_NEAR(lengthOf(order(dieline, 0.0, {}, faults), 11), 2.0 * lengthOf(order(dieline, 0.0), 11), 1e-9);
}

TEST(Perforation, BeginsAndEndsWithADashAndKeepsTheRatio) {
  const Pieces pieces = order(test::dielineOf({test::line(-40, 0, 0, 0, Process::kPerforation)}), 0.0);
  ASSERT_EQ(pieces.size(), 1U);
  const auto& dashes = pieces[0];
  EXPECT_EQ(dashes.size(), 10U);
  const auto [low, high] = std::minmax(dashes.front().start_mm.x(), dashes.back().end_mm.x());
  EXPECT_NEAR(low, -40.0, 1e-9);
  EXPECT_NEAR(high, 0.0, 1e-9);
  for (std::size_t i = 1; i < dashes.size(); ++i) {
    const double gap = (dashes[i].start_mm - dashes[i - 1].end_mm).norm();
    EXPECT_NEAR(dashes[i].lengthMm() / gap, 3.0, 1e-9);
  }
}

TEST(Perforation, BeginsAnewAtACornerWithACut) {
  for (const OrderOptions& options : {OrderOptions{}, OrderOptions{.break_at_corners = true}}) {
    const Pieces pieces = order(test::dielineOf({test::line(-40, 0, 0, 0, Process::kPerforation),
                                                 test::line(0, 0, 0, 22, Process::kPerforation)}),
                                0.0, options);
    std::vector<Segment> dashes;
    for (const auto& piece : pieces) dashes.insert(dashes.end(), piece.begin(), piece.end());
    EXPECT_EQ(dashes.size(), 10U + 6U);  // 40 and 22 mm, of 3 and 1 mm.
    const auto at_corner = [](const Segment& s) {
      return std::min(s.start_mm.norm(), s.end_mm.norm()) < 1e-9;
    };
    EXPECT_EQ(std::ranges::count_if(dashes, at_corner), 2);
  }
}

TEST(Perforation, AsDrawnHasTheSamePatternOverTwoEntities) {
  JobParameters job;
  job.order = JobParameters::Order::kDrawn;
  const auto lengthOfAll = [&](const dieline::Dieline& dieline) {
    double length_mm = 0.0;
    for (const auto& piece : piecesOf(drawnOrder(dieline, job, {}), job))
      for (const Segment& s : piece) length_mm += s.lengthMm();
    return length_mm;
  };
  const double whole = lengthOfAll(test::dielineOf({test::line(-40, 0, 0, 0, Process::kPerforation)}));
  const double parts = lengthOfAll(test::dielineOf(
      {test::line(-40, 0, -18, 0, Process::kPerforation), test::line(0, 0, -18, 0, Process::kPerforation)}));
  EXPECT_NEAR(parts, whole, 1e-9);
}

TEST(Perforation, ClosedOnesEndWithAGap) {
  dieline::Entity circle = test::arc(-30, 0, 10, 0, 360);
  circle.process = Process::kPerforation;
  const Pieces pieces = order(test::dielineOf({circle}), 0.0);
  EXPECT_NEAR((pieces[0].front().start_mm - pieces[0].back().end_mm).norm(), 1.0, 0.05);
}

}  // namespace
}  // namespace kerfbench::planner
