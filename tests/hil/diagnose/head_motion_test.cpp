// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/head_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kerfbench::diagnose {
namespace {

using Eigen::Vector2d;
using ::testing::HasSubstr;

/// The head of Hu, Hu, Jiang 2014 (S0) over its first piece: it waits 6 s, goes along with the strip at 200
/// mm/s while it cuts 800 mm at 230 mm/s, and comes back at 400 mm/s.
MotionSource paperHead() {
  const double cut_s = 800.0 / 230.0;
  const double back_s = 200.0 * cut_s / 400.0;
  MotionSource source;
  source.place_W_mm = [=](double t) -> Vector2d {
    const double cutting_s = std::clamp(t - 6.0, 0.0, cut_s);
    const double returning_s = std::clamp(t - 6.0 - cut_s, 0.0, back_s);
    return {200.0 * cutting_s - 400.0 * returning_s, 230.0 * cutting_s};
  };
  source.sheet_x_mm = [](double t) { return 200.0 * t; };
  source.gates_s = {{6.0, 6.0 + cut_s}};
  source.end_s = 12.0;
  return source;
}

TEST(HeadMotion, HasThePapersLengthOfWay) {
  const HeadMotion motion = headMotion(paperHead(), 0.01);
  const double cut_mm = std::hypot(200.0, 230.0) * 800.0 / 230.0;
  const double back_mm = 200.0 * 800.0 / 230.0;
  const auto at = [&](double time_s) {
    return *std::ranges::find_if(motion.instants,
                                 [&](const MotionInstant& it) { return it.time_s >= time_s - 1e-9; });
  };
  EXPECT_NEAR(at(6.0).path_mm, 0.0, 1e-9);
  EXPECT_NEAR(at(7.0).path_mm, std::hypot(200.0, 230.0), 1e-6) << "the slope of figure 6";
  EXPECT_NEAR(motion.cuts.front().to_s, 9.478, 0.001);
  EXPECT_NEAR(at(12.0).path_mm, cut_mm + back_mm, 0.05) << "chords across the turn are a little shorter";
  EXPECT_TRUE(at(8.0).lit);
  EXPECT_FALSE(at(10.0).lit);
}

TEST(HeadMotion, ACutAtRestOnTheSheetGoesStraightAcross) {
  const MotionCut cut = headMotion(paperHead(), 0.01).cuts.front();
  EXPECT_NEAR(cut.overSheet_mm().x(), 0.0, 1e-9);
  EXPECT_NEAR(cut.overSheet_mm().y(), 800.0, 1e-9);
  EXPECT_NEAR(cut.velocityW().x(), 200.0, 1e-9);
  EXPECT_NEAR(cut.velocityW().y(), 230.0, 1e-9);
}

TEST(HeadMotion, TellsInstantsAndCuts) {
  const HeadMotion motion = headMotion(paperHead(), 3.0);
  EXPECT_EQ(motionTable(motion),
            "t_s,x_W_mm,y_W_mm,sheet_x_mm,gate,G_mm\n"
            "0.000000,0.0000,0.0000,0.0000,0,0.0000\n"
            "3.000000,0.0000,0.0000,600.0000,0,0.0000\n"
            "6.000000,0.0000,0.0000,1200.0000,1,0.0000\n"
            "9.000000,600.0000,690.0000,1800.0000,1,914.3850\n"
            "9.478261,695.6522,800.0000,1895.6522,0,1060.1566\n"
            "12.000000,0.0000,800.0000,2400.0000,0,1755.8087\n");
  EXPECT_THAT(cutTable(motion), HasSubstr("6.0000    9.4783      0.000      0.000    695.652    800.000"));
  EXPECT_THAT(lengthPicture(motion), HasSubstr(">G(t)<"));
}

TEST(HeadMotion, PartsTheWayWhereTheBeamHasNoPlace) {
  MotionSource source = paperHead();
  const auto whole = source.place_W_mm;
  source.place_W_mm = [whole](double t) -> Vector2d {
    if (t > 7.0 && t < 8.0) return Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
    return whole(t);
  };
  const HeadMotion motion = headMotion(source, 0.1);
  EXPECT_TRUE(std::isfinite(motion.instants.back().path_mm));
  EXPECT_THAT(wayPicture(motion), HasSubstr("</svg>"));
  EXPECT_THAT(sheetPicture(motion), HasSubstr("x_S, mm"));
}

}  // namespace
}  // namespace kerfbench::diagnose
