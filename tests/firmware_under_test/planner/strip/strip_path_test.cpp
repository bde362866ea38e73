// SPDX-License-Identifier: Apache-2.0
// S0's G(t) against the paper's own times and slopes, and against a head that is moved on in small steps.
#include "firmware_under_test/planner/strip/strip_path.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/planner/strip/strip_pictures.h"
#include "tests/firmware_under_test/planner/player.h"

namespace kerfbench::planner {
namespace {

using ::testing::HasSubstr;

constexpr double kFeed_mm_s = 200.0;

/// Feed of the scenario strip-speed-varies during the first cut: 1.1 % too fast, then 0.4 % too slow.
constexpr const char* kVarying = "6:200,6.2:202.2,6.8:202.2,7:200,7.2:199.2,9.2:199.2,9.4:200";

std::vector<StripSpan> cutsOf(const StripPath& path) {
  std::vector<StripSpan> cuts;
  for (const StripSpan& span : path.spans())
    if (span.kind == StripSpan::Kind::kCut) cuts.push_back(span);
  return cuts;
}

TEST(StripPath, StopAndGoHasThePapersHalfPeriods) {
  const StripPath path(test::paperCut(), StripMethod::kStopAndGo, StripFeed(kFeed_mm_s), 3);
  const double half_s = 6.0 + 800.0 / 230.0;  // T / 2; the paper rounds it to 9.5 s.
  for (int n = 1; n <= 3; ++n) {
    const StripSpan cut = cutsOf(path)[static_cast<std::size_t>(n - 1)];
    EXPECT_NEAR(cut.from_s, (n - 1) * half_s + 6.0, 1e-9);
    EXPECT_NEAR(cut.to_s, n * half_s, 1e-9);
    EXPECT_NEAR(path.at(cut.from_s - 1.0).path_mm, (n - 1) * 800.0, 1e-9)
        << "eq. 3: G = (n - 1) y0 while the strip is fed";
    EXPECT_EQ(path.at(cut.from_s - 1.0).speed_mm_s, 0.0);
    EXPECT_EQ(path.at(cut.from_s + 1.0).speed_mm_s, 230.0);
  }
  EXPECT_NEAR(path.at(path.endS()).place_mm.y(), 800.0, 1e-9) << "the third cut runs forth";
}

TEST(StripPath, OnTheRunHasThePapersTimesAndSlopes) {
  const StripPath path(test::paperCut(), StripMethod::kContinuous, StripFeed(kFeed_mm_s), 2);
  const std::vector<StripSpan> cuts = cutsOf(path);
  EXPECT_NEAR(cuts[0].from_s, 6.0, 1e-9);
  EXPECT_NEAR(cuts[0].to_s, 9.5, 0.03) << "the paper: about 9.5 s";
  EXPECT_NEAR(cuts[1].to_s, 15.5, 0.03);
  EXPECT_NEAR(path.at(7.0).speed_mm_s, std::hypot(200.0, 230.0), 1e-9) << "figure 6: tan alpha";
  EXPECT_NEAR(path.at(10.0).speed_mm_s, 400.0, 1e-9) << "figure 6: tan beta";
  EXPECT_EQ(path.at(11.9).speed_mm_s, 0.0) << "the head waits for the strip";
  EXPECT_NEAR(path.at(11.9).place_mm.x(), 0.0, 1e-9);
  EXPECT_NEAR(path.at(11.9).place_mm.y(), 800.0, 1e-9);
  EXPECT_NEAR(path.at(path.endS()).place_mm.norm(), 0.0, 1e-9) << "a cycle of two pieces ends where it began";
}

TEST(StripPath, CutsThatFollowWithoutWaitingBeginAtThePapersTimes) {
  CrossCut cut = test::paperCut();
  // (v_x / v_y)(v_x / v_0 + 1) y0 = L
  cut.reposition_mm_s = cut.feed_mm_s / (cut.piece_mm / cut.carriedMm() - 1.0);
  EXPECT_NEAR(cut.reposition_mm_s, 275.9, 0.05);
  const StripPath path(cut, StripMethod::kContinuous, StripFeed(kFeed_mm_s), 4);
  for (int n = 1; n <= 4; ++n) {
    const double paper_s = 6.0 + (n - 1) * (800.0 / 230.0) * (1.0 + 200.0 / cut.reposition_mm_s);
    EXPECT_NEAR(cutsOf(path)[static_cast<std::size_t>(n - 1)].from_s, paper_s, 1e-9);
  }
}

/// A head that knows nothing of spans: it looks at the strip each 10 µs and goes on by its speed.
struct SteppedHead {
  double x_mm{}, y_mm{}, path_mm{};
  int cuts{};
};

SteppedHead steppedTo(double end_s) {
  constexpr double kStep_s = 1e-5;
  const CrossCut cut = test::paperCut();
  SteppedHead head;
  bool cutting = false;
  for (long i = 0; static_cast<double>(i) * kStep_s < end_s; ++i) {
    const double strip_mm = cut.feed_mm_s * static_cast<double>(i) * kStep_s;
    if (!cutting && head.x_mm <= 1e-9 && strip_mm >= cut.piece_mm * (head.cuts + 1) - 1e-9) cutting = true;
    double vx = 0.0, vy = 0.0;
    if (cutting) {
      vx = cut.feed_mm_s;
      vy = head.cuts % 2 == 0 ? cut.cut_mm_s : -cut.cut_mm_s;
    } else if (head.x_mm > 1e-9) {
      vx = -std::min(cut.reposition_mm_s, head.x_mm / kStep_s);
    }
    head.x_mm += vx * kStep_s;
    head.y_mm += vy * kStep_s;
    head.path_mm += std::hypot(vx, vy) * kStep_s;
    if (cutting && (head.cuts % 2 == 0 ? head.y_mm >= cut.width_mm : head.y_mm <= 0.0)) {
      cutting = false;
      ++head.cuts;
    }
  }
  return head;
}

TEST(StripPath, AHeadMovedInSmallStepsGoesTheSameWay) {
  const StripPath path(test::paperCut(), StripMethod::kContinuous, StripFeed(kFeed_mm_s), 2);
  for (const double time_s : {5.0, 6.5, 9.0, 10.3, 11.8, 13.1, 15.6, 16.9}) {
    const SteppedHead head = steppedTo(time_s);
    EXPECT_NEAR(path.at(time_s).path_mm, head.path_mm, 0.02) << time_s;
    EXPECT_NEAR(path.at(time_s).place_mm.x(), head.x_mm, 0.02) << time_s;
    EXPECT_NEAR(path.at(time_s).place_mm.y(), head.y_mm, 0.02) << time_s;
  }
}

TEST(StripPath, SlopesAreTheDerivativeOfTheWay) {
  const StripPath path(test::paperCut(), StripMethod::kContinuous, StripFeed(kFeed_mm_s), 2);
  for (const StripSpan& span : path.spans()) {
    const double middle_s = 0.5 * (span.from_s + span.to_s);
    constexpr double kHalf_s = 1e-4;
    EXPECT_NEAR((path.at(middle_s + kHalf_s).path_mm - path.at(middle_s - kHalf_s).path_mm) / (2.0 * kHalf_s),
                path.at(middle_s).speed_mm_s, 1e-6);
  }
}

TEST(StripPath, TheMeanSpeedMisplacesPointsWithinACut) {
  CrossCut cut = test::paperCut();
  const StripFeed feed = StripFeed::parse(kVarying);
  const StripPath path(cut, StripMethod::kMeanSpeed, feed, 1);
  const StripSpan span = cutsOf(path).front();
  // The same by adding up the speed: how far the strip is from where its mean would have it.
  double strip_mm = 0.0, farthest_mm = 0.0;
  constexpr int kSteps = 400'000;
  const double step_s = (span.to_s - span.from_s) / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    strip_mm += feed.speedMm_s(span.from_s + (i + 0.5) * step_s) * step_s;
    farthest_mm = std::max(farthest_mm, std::abs(strip_mm - span.velocity_mm_s.x() * (i + 1) * step_s));
  }
  EXPECT_NEAR(path.farthestOffMm(), farthest_mm, 1e-4);
  EXPECT_GT(path.farthestOffMm(), 1.5) << "thirty times what may be wrong with a cut";
  EXPECT_NEAR(path.at(span, span.to_s).off_sheet_mm, 0.0, 1e-9) << "the mean is right at the end";
  EXPECT_LT(StripPath(cut, StripMethod::kContinuous, StripFeed(kFeed_mm_s), 2).farthestOffMm(), 1e-9);
}

TEST(StripPath, AHeadThatIsNotBackInTimeIsRefusedWithThePiece) {
  CrossCut cut = test::paperCut();
  cut.piece_mm = 1044.0;  // Enough at 200 mm/s: the cycle takes 1043.5 mm.
  EXPECT_EQ(cutsOf(StripPath(cut, StripMethod::kMeanSpeed, StripFeed(kFeed_mm_s), 3)).size(), 3U);
  const auto faster = [&] {
    StripPath(cut, StripMethod::kMeanSpeed, StripFeed::parse("0:200,12:200,13:212"), 4);
  };
  EXPECT_THAT(test::refusal(faster), HasSubstr("piece 3 has passed at"));
  const auto faster_than_reach = [&] { StripPath(cut, StripMethod::kMeanSpeed, StripFeed(230.0), 1); };
  EXPECT_THAT(test::refusal(faster_than_reach), HasSubstr("piece 1: the strip carries the head 800.0 mm"));
  cut.piece_mm = 1043.0;
  EXPECT_THAT(test::refusal([&] { StripPath(cut, StripMethod::kContinuous, StripFeed(kFeed_mm_s), 1); }),
              HasSubstr("a piece has 1043 mm"));
}

TEST(StripFeed, TravelAndTimeAreInverse) {
  const StripFeed feed = StripFeed::parse(kVarying);
  EXPECT_EQ(feed.lowestMm_s(), 199.2);
  EXPECT_EQ(feed.highestMm_s(), 202.2);
  EXPECT_NEAR(feed.travelMm(6.0), 1200.0, 1e-9);
  EXPECT_NEAR(feed.travelMm(6.2) - feed.travelMm(6.0), 0.5 * (200.0 + 202.2) * 0.2, 1e-9);
  for (double time_s = 0.0; time_s < 12.0; time_s += 0.137)
    EXPECT_NEAR(feed.timeS(feed.travelMm(time_s)), time_s, 1e-9);
}

TEST(StripFeed, NamesAllThatIsWrong) {
  EXPECT_THAT(test::refusal([] { StripFeed::parse("0:200,1:0,1:-3"); }),
              testing::AllOf(HasSubstr("at 1 s must be > 0 mm/s, but is 0"), HasSubstr("but is -3"),
                             HasSubstr("times of the feed must rise, but 1 s follows 1 s")));
  EXPECT_THAT(test::refusal([] { StripFeed::parse("0:200,fast"); }), HasSubstr("not 'fast'"));
}

TEST(StripTable, HasBothSidesOfEachBorder) {
  const StripPath path(test::paperCut(), StripMethod::kContinuous, StripFeed(kFeed_mm_s), 1);
  const std::string table = stripTable(path, 0.5);
  EXPECT_THAT(table,
              HasSubstr("\n6.000000,1,wait,0.00000,0.00000,0.00000,0.00000,0.00000,0.00000,0.00000\n"
                        "6.000000,1,cut,0.00000,0.00000,200.00000,230.00000,0.00000,304.79501,0.00000\n"));
  EXPECT_THAT(stripPathPicture(path), HasSubstr("</svg>"));
  EXPECT_THAT(stripLengthPicture(path), HasSubstr(">G(t)<"));
}

}  // namespace
}  // namespace kerfbench::planner
