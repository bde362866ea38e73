// SPDX-License-Identifier: Apache-2.0
// Where and when the worst value of a check was found.
#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/evidence/spot_association.h"
#include "hil/inspect/evidence/whereabouts.h"
#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::inspect {
namespace {

using testing::checkOf;
using testing::kCreaseLine;
using testing::kHole;
using testing::kRight;
using testing::SyntheticRun;
using Time = Whereabouts::Time;

constexpr double kFrame_s = 1e-3;
constexpr double kSpeed_mm_s = 300.0;

LitFrames followed(const SyntheticRun& run) {
  return followDieline(run.evidence.spot, run.dieline, run.evidence.gates);
}

/// Where the spot was at a time, by the frames on either side; they are lit.
Eigen::Vector2d placeAt(const LitFrames& lit, double time_s) {
  std::size_t i = 0;
  while (lit.frames[i + 1].time_s < time_s) ++i;
  const LitFrame& a = lit.frames[i];
  const LitFrame& b = lit.frames[i + 1];
  return a.p_S_mm + (time_s - a.time_s) / (b.time_s - a.time_s) * (b.p_S_mm - a.p_S_mm);
}

TEST(WhereaboutsTest, OfAPlaceHaveTheTimeAtWhichTheSpotPassedIt) {
  const SyntheticRun run;
  const LitFrames lit = followed(run);
  for (const double y_mm : {3.1, 17.77, 36.0}) {
    Whereabouts where = atPlace(1, kRight, {60.0, y_mm});
    complete(where, lit, run.dieline);
    ASSERT_EQ(where.time, Time::kPassing) << y_mm;
    EXPECT_NEAR(where.within_s, 0.5 * kFrame_s, 1e-9);
    EXPECT_LT((placeAt(lit, where.time_s) - Eigen::Vector2d(60.0, y_mm)).norm(), 0.02) << y_mm;
  }
}

TEST(WhereaboutsTest, AreThoseOfTheirUnitAndLine) {
  const SyntheticRun run;
  const LitFrames lit = followed(run);
  Whereabouts first = atPlace(0, kRight, {60.0, 20.0});
  Whereabouts second = atPlace(1, kRight, {60.0, 20.0});
  complete(first, lit, run.dieline);
  complete(second, lit, run.dieline);
  ASSERT_TRUE(first.hasTime() && second.hasTime());
  EXPECT_GT(second.time_s, first.time_s + 0.3);
  // The spot follows the crease long after the outline, which passes the same place but for 0.25 mm.
  Whereabouts crease = atPlace(0, kCreaseLine, {30.0, 2.1});
  complete(crease, lit, run.dieline);
  ASSERT_TRUE(crease.hasTime());
  EXPECT_LT((placeAt(lit, crease.time_s) - Eigen::Vector2d(30.0, 2.1)).norm(), 0.1);
}

TEST(WhereaboutsTest, OfAPlaceThatTheSpotNeverPassedHaveNoTime) {
  const SyntheticRun run;
  Whereabouts where = atPlace(0, -1, {22.0, 30.0});
  complete(where, followed(run), run.dieline);
  EXPECT_FALSE(where.hasTime());
  EXPECT_EQ(where.time, Time::kNone);
  Whereabouts of_no_unit;
  complete(of_no_unit, followed(run), run.dieline);
  EXPECT_FALSE(of_no_unit.hasTime());
}

TEST(WhereaboutsTest, OfACutBesideItsLineHaveTheTimeToo) {
  // The whole line was cut half a millimetre aside, beyond the reach of the association.
  SyntheticRun run;
  run.shiftSpot(1, kRight, [](double) { return Eigen::Vector2d(0.5, 0.0); });
  Whereabouts where = atPlace(1, kRight, {60.0, 20.0});
  complete(where, followed(run), run.dieline);
  ASSERT_EQ(where.time, Time::kPassing);
  Whereabouts as_drawn = atPlace(1, kRight, {60.0, 20.0});
  complete(as_drawn, followed(SyntheticRun()), run.dieline);
  EXPECT_NEAR(where.time_s, as_drawn.time_s, kFrame_s);
}

TEST(WhereaboutsTest, OfATimeHaveThePlaceOfTheSpot) {
  const SyntheticRun run;
  const LitFrames lit = followed(run);
  const LitFrame& frame = lit.frames[40];
  Whereabouts where = atTime(frame.time_s + 0.1 * kFrame_s);
  complete(where, lit, run.dieline);
  EXPECT_EQ(where.time, Time::kPins);
  EXPECT_EQ(where.unit, frame.unit);
  EXPECT_EQ(where.entity, frame.entity);
  EXPECT_DOUBLE_EQ(where.x_mm, frame.p_S_mm.x());
  Whereabouts dark = atTime(0.0);  // Before the first cut.
  complete(dark, lit, run.dieline);
  EXPECT_FALSE(dark.hasPlace());
  EXPECT_FALSE(atTime(std::nan("")).hasTime());
}

TEST(WhereaboutsTest, OfALineAsAWholeHaveItsMiddle) {
  const SyntheticRun run;
  const LitFrames lit = followed(run);
  Whereabouts where = onLine(0, kHole);
  complete(where, lit, run.dieline);
  ASSERT_EQ(where.time, Time::kMidway);
  const Eigen::Vector2d middle_mm =
      dieline::pointAt(run.dieline.entities[static_cast<std::size_t>(kHole)].curve, 0.5);
  EXPECT_LT((placeAt(lit, where.time_s) - middle_mm).norm(), 0.05);
}

TEST(WhereaboutsTest, AreThoseOfTheFaultInEachCheck) {
  SyntheticRun run;
  for (vision::Caliper& c : run.kerf(1, kRight).calipers)
    if (c.station_mm > 14.0 && c.station_mm < 16.0) c.offset_mm += 0.2;
  run.shiftSpot(0, kCreaseLine, [](double t_s) { return Eigen::Vector2d(t_s / 0.12 * 0.15, 0.0); });
  const InspectionResult result = run.inspected();
  const Check& path = checkOf(result, "path");
  EXPECT_EQ(path.where.unit, 1);
  EXPECT_EQ(path.where.entity, kRight);
  EXPECT_NEAR(path.where.y_mm, 15.0, 1.0);
  EXPECT_EQ(path.where.time, Time::kPassing);
  const Check& still = checkOf(result, "stillness_x");
  EXPECT_EQ(still.where.unit, 0);
  EXPECT_EQ(still.where.entity, kCreaseLine);
  EXPECT_EQ(still.where.time, Time::kFrame);
  EXPECT_GT(still.where.y_mm, 30.0);  // The spot drifts away: the end of the line lies farthest off.
}

TEST(WhereaboutsTest, DecideNothing) {
  // What a check is worth must not hang on where it is.
  SyntheticRun run;
  for (vision::FrameMeasurement& frame : run.evidence.spot.frames) frame.mid_s += 100.0;
  for (GateInterval& gate : run.evidence.gates) {
    gate.on_s += 100.0;
    gate.off_s += 100.0;
  }
  for (Span& span : run.evidence.light) {
    span.from_s += 100.0;
    span.to_s += 100.0;
  }
  for (BeltEdge& edge : run.evidence.belt) edge.time_s += 100.0;
  const InspectionResult later = run.inspected();
  const InspectionResult now = SyntheticRun().inspected();
  ASSERT_EQ(later.checks.size(), now.checks.size());
  for (std::size_t i = 0; i < now.checks.size(); ++i)
    EXPECT_EQ(later.checks[i].verdict, now.checks[i].verdict) << now.checks[i].name;
}

TEST(GrossFaults, ADistanceBeyondTheSearchIsABound) {
  SyntheticRun run;
  run.shiftSpot(1, kCreaseLine, [](double) { return Eigen::Vector2d(4.0, 0.0); });
  const Check check = checkOf(run.inspected(), "spot_path");
  EXPECT_EQ(check.verdict, Verdict::kFail);
  EXPECT_TRUE(check.at_least);
  EXPECT_DOUBLE_EQ(check.value, kSearch_mm);
  EXPECT_EQ(check.where.unit, 1);
}

TEST(GrossFaults, ABoundWithinTheLimitProvesNothing) {
  Check check{.name = "spot_path", .value = 1.0, .limit = 2.0, .guard = 0.01};
  EXPECT_EQ(decideAtLeast(check), Verdict::kInvalid);
  EXPECT_FALSE(check.at_least);
  EXPECT_TRUE(std::isnan(check.value));
  check.value = 1.0;
  check.limit = 0.5;
  EXPECT_EQ(decideAtLeast(check), Verdict::kFail);
  EXPECT_TRUE(check.at_least);
}

TEST(GrossFaults, ASpotFarFromTheLineThatItLeftTellsNoDrift) {
  // The beam leaves the crease and comes back to it: 12 mm in between are no drift of the beam on its line.
  SyntheticRun run;
  run.shiftSpot(1, kCreaseLine,
                [](double t_s) { return Eigen::Vector2d(t_s > 0.05 && t_s < 0.07 ? 12.0 : 0.0, 0.0); });
  const InspectionResult result = run.inspected();
  const Check& peak = checkOf(result, "stillness_peak");
  EXPECT_LT(peak.value, kSearch_mm);
  // The motion is proven all the same: from within 0.3 mm of the line to beyond 1 mm.
  const Check& still = checkOf(result, "stillness_x");
  EXPECT_EQ(still.verdict, Verdict::kFail);
  EXPECT_TRUE(still.at_least);
  EXPECT_DOUBLE_EQ(still.value, kSearch_mm - kReach_mm);
  EXPECT_EQ(checkOf(result, "spot_path").verdict, Verdict::kFail);
  EXPECT_EQ(result.verdict, Verdict::kFail);
}

TEST(GrossFaults, AKerfNoWiderThanNothingIsNone) {
  SyntheticRun run;
  for (vision::Caliper& c : run.kerf(1, kRight).calipers) c.width_mm = -0.021;
  const InspectionResult result = run.inspected();
  for (const EntityResult& e : result.entities) EXPECT_FALSE(e.width_mm <= 0.0);
  EXPECT_EQ(checkOf(result, "kerf_width").explanation.find("-0.021"), std::string::npos);
}

TEST(GrossFaults, APathIsABoundWhereLinesGaveNoReading) {
  SyntheticRun run;
  for (vision::Caliper& c : run.kerf(1, kRight).calipers) c.offset_mm += 0.2;
  EXPECT_FALSE(checkOf(run.inspected(), "path").at_least);
  for (vision::Caliper& c : run.kerf(0, kRight).calipers) testing::unburn(c);
  const Check path = checkOf(run.inspected(), "path");
  EXPECT_EQ(path.verdict, Verdict::kFail);
  EXPECT_TRUE(path.at_least);
}

}  // namespace
}  // namespace kerfbench::inspect
