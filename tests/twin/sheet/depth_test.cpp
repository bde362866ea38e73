// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "twin/sheet/sheet.h"

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;

/// A curve as S3 measures one: depth over P_ua in J/mm², with a threshold, steep, then saturating.
struct Experiment {
  double p_ua_j_mm2, depth;
};
constexpr std::array<Experiment, 8> kExperiment{{{0.05, 0.0},
                                                 {0.08, 0.06},
                                                 {0.12, 0.21},
                                                 {0.17, 0.43},
                                                 {0.23, 0.62},
                                                 {0.30, 0.79},
                                                 {0.38, 0.92},
                                                 {0.48, 1.0}}};
/// Fluence at the centre of a line of which P_ua = P / (F d), d = 2 w: from the Gaussian's integral.
const double kCentrePerPua = 2.0 * std::sqrt(2.0 / std::numbers::pi);

double depthOf(double p_ua_j_mm2) {
  for (std::size_t i = 1; i < kExperiment.size(); ++i) {
    const auto [p0, d0] = kExperiment.at(i - 1);
    const auto [p1, d1] = kExperiment.at(i);
    if (p_ua_j_mm2 <= p1) return std::max(0.0, d0 + (d1 - d0) * (p_ua_j_mm2 - p0) / (p1 - p0));
  }
  return 1.0;
}

BoardDescription experimentalBoard() {
  BoardDescription board;
  board.cut_fluence_j_mm2 = kCentrePerPua * kExperiment.back().p_ua_j_mm2;
  for (const Experiment& e : kExperiment) {
    board.depth_curve.push_back({e.p_ua_j_mm2 / kExperiment.back().p_ua_j_mm2, e.depth});
  }
  return board;
}

void cutLine(Sheet& sheet, const Vector2d& from_mm, const Vector2d& to_mm, double radius_mm, double power_w,
             double speed_mm_s) {
  sheet.burn({from_mm, radius_mm, radius_mm}, {to_mm, radius_mm, radius_mm},
             power_w * (to_mm - from_mm).norm() / speed_mm_s);
}

/// Test of a straight cut by speed, spot diameter and direction.
class StraightCut : public testing::TestWithParam<std::tuple<double, double, double>> {};

TEST_P(StraightCut, IsAsDeepAsItsPowerOverSpeedAndSpotSays) {
  const auto [speed_mm_s, spot_mm, angle_rad] = GetParam();
  const Vector2d along(std::cos(angle_rad), std::sin(angle_rad));
  double worst = 0.0;
  for (int i = 1; i <= 60; ++i) {
    const double p_ua_j_mm2 = 0.01 * i;
    Sheet sheet(experimentalBoard());
    const Vector2d middle(0.00137 * i - 3.0, 7.0 - 0.0031 * i);  // The place is anywhere between the nodes.
    const double power_w = p_ua_j_mm2 * speed_mm_s * spot_mm;
    cutLine(sheet, middle - 1.5 * along, middle + 1.5 * along, 0.5 * spot_mm, power_w, speed_mm_s);
    for (const double station_mm : {-0.513, 0.0, 0.249}) {
      const double error = sheet.depthAt(middle + station_mm * along) - depthOf(p_ua_j_mm2);
      worst = std::max(worst, std::abs(error));
      EXPECT_NEAR(error, 0.0, 0.002) << "P_ua " << p_ua_j_mm2 << " at " << station_mm;
    }
  }
  RecordProperty("worst_depth_error", std::to_string(worst));
}

INSTANTIATE_TEST_SUITE_P(SpeedSpotDirection, StraightCut,
                         testing::Combine(testing::Values(50.0, 300.0, 1500.0),
                                          testing::Values(0.15, 0.21, 0.35, 0.5),
                                          testing::Values(0.0, 0.4, 0.7853981634, 1.5707963268, 2.3)));

/// Test by the peak fluence of the cut over the fluence that cuts through.
class OpenKerf : public testing::TestWithParam<double> {};

TEST_P(OpenKerf, IsAsWideAsTheGaussianIsAboveTheFluenceThatCuts) {
  const double radius_mm = 0.105;
  const Sheet blank(experimentalBoard());
  const double peak_j_mm2 = GetParam() * blank.board().cut_fluence_j_mm2;
  const double power_w = peak_j_mm2 * 300.0 * 2.0 * radius_mm / kCentrePerPua;
  const double expected_mm = radius_mm * std::sqrt(2.0 * std::log(GetParam()));
  for (const double angle_rad : {0.0, 0.3, 0.9, 1.5707963268}) {
    const Vector2d along(std::cos(angle_rad), std::sin(angle_rad));
    const Vector2d across(-along.y(), along.x());
    const Vector2d middle(1.0073, -2.0019);
    Sheet sheet = blank;
    cutLine(sheet, middle - 1.5 * along, middle + 1.5 * along, radius_mm, power_w, 300.0);
    double width_mm = 0.0;
    for (const double side : {1.0, -1.0}) {
      double open_mm = 0.0;
      double shut_mm = 0.4;
      while (shut_mm - open_mm > 1e-6) {
        const double mid_mm = 0.5 * (open_mm + shut_mm);
        (sheet.depthAt(middle + side * mid_mm * across) >= 1.0 ? open_mm : shut_mm) = mid_mm;
      }
      width_mm += open_mm;
    }
    EXPECT_NEAR(width_mm, expected_mm, 1e-3) << angle_rad;
  }
}

INSTANTIATE_TEST_SUITE_P(PeakOverCut, OpenKerf,
                         testing::Values(1.02, 1.05, 1.1, 1.25, 1.5, 2.0, 3.0, 5.0, 8.0));

TEST(DepthCurve, IsItsOwnInverse) {
  const DepthCurve curve(experimentalBoard());
  for (double depth = 0.01; depth < 1.0; depth += 0.01) {
    EXPECT_NEAR(curve.depthAt(curve.fluenceFor_j_mm2(depth)), depth, 1e-12);
  }
  const double threshold_j_mm2 = kCentrePerPua * 0.05;
  EXPECT_NEAR(curve.fluenceFor_j_mm2(0.0), threshold_j_mm2, 1e-12);
  EXPECT_EQ(curve.depthAt(0.999 * threshold_j_mm2), 0.0);
  EXPECT_EQ(curve.depthAt(0.0), 0.0);
  EXPECT_EQ(curve.fluenceFor_j_mm2(1.0), curve.fluenceFor_j_mm2(2.0));
  EXPECT_EQ(curve.depthAt(curve.fluenceFor_j_mm2(1.0)), 1.0);
  EXPECT_EQ(curve.depthAt(1e9), 1.0);
}

TEST(DepthCurve, WithoutPointsIsTheStraightLine) {
  const BoardDescription board;
  const DepthCurve curve(board);
  for (double share = 0.0; share <= 1.0; share += 0.125) {
    EXPECT_EQ(curve.depthAt(share * board.cut_fluence_j_mm2), share);
    EXPECT_EQ(curve.fluenceFor_j_mm2(share), share * board.cut_fluence_j_mm2);
  }
}

TEST(Threshold, BoardBelowItIsUntouchedAndASecondPassAddsToTheFirst) {
  Sheet sheet(experimentalBoard());
  const double below_w = 0.04 * 300.0 * 0.21;
  cutLine(sheet, {-1.0, 0.0}, {1.0, 0.0}, 0.105, below_w, 300.0);
  EXPECT_EQ(sheet.depthAt({0.0, 0.0}), 0.0);
  EXPECT_GT(sheet.fluenceAt({0.0, 0.0}), 0.0);
  EXPECT_TRUE(sheet.untouched({-2.0, -2.0}, {2.0, 2.0}));
  cutLine(sheet, {-1.0, 0.0}, {1.0, 0.0}, 0.105, below_w, 300.0);
  EXPECT_NEAR(sheet.depthAt({0.0, 0.0}), depthOf(0.08), 0.002);
  EXPECT_FALSE(sheet.untouched({-2.0, -2.0}, {2.0, 2.0}));
  EXPECT_FALSE(sheet.untouched({0.0, 0.0}, {0.0, 0.0}));
  EXPECT_TRUE(sheet.untouched({-2.0, 0.3}, {2.0, 2.0}));
}

TEST(Threshold, WhereTheSheetIsUntouchedNoDepthIsFound) {
  Sheet sheet(experimentalBoard());
  cutLine(sheet, {-1.0, -0.2}, {1.0, 0.3}, 0.105, 0.1 * 300.0 * 0.21, 300.0);
  int untouched = 0, touched = 0;
  for (double x = -1.4; x < 1.4; x += 0.0333) {
    for (double y = -0.6; y < 0.6; y += 0.0271) {
      if (sheet.untouched({x, y}, {x, y})) {
        EXPECT_LE(sheet.depthAt({x, y}), Sheet::kUntouchedDepth);
        ++untouched;
      } else {
        ++touched;
      }
    }
  }
  EXPECT_GT(untouched, 1000);
  EXPECT_GT(touched, 100);
}

BoardDescription scorchingBoard() {
  BoardDescription board;
  board.scorch = {.fluence_j_mm2 = 0.2, .darkening = 0.3, .shift_mm = {0.06, -0.02}};
  return board;
}

TEST(Scorch, LiesBesideTheBurnWhereTheAirBlowsIt) {
  Sheet sheet(scorchingBoard());
  cutLine(sheet, {0.0, -2.0}, {0.0, 2.0}, 0.105, 0.1 * 300.0 * 0.21, 300.0);
  double weight = 0.0, moment = 0.0;
  for (double x = -0.5; x < 0.5; x += 0.001) {
    const double scorch = sheet.scorchAt({x, 0.0});
    EXPECT_NEAR(scorch, std::min(1.0, sheet.fluenceAt({x - 0.06, 0.02}) / 0.2), 1e-12);
    weight += scorch;
    moment += scorch * x;
  }
  EXPECT_NEAR(moment / weight, 0.06, 1e-3);
}

TEST(Scorch, ReachesOneAndNoMore) {
  Sheet sheet(scorchingBoard());
  cutLine(sheet, {0.0, -2.0}, {0.0, 2.0}, 0.105, 0.6 * 300.0 * 0.21, 300.0);
  EXPECT_EQ(sheet.scorchAt({0.06, 0.0}), 1.0);
  EXPECT_EQ(sheet.scorchAt({1.0, 0.0}), 0.0);
}

TEST(Scorch, IsNoneOnBoardThatDoesNotScorch) {
  Sheet sheet{BoardDescription{}};
  cutLine(sheet, {0.0, -2.0}, {0.0, 2.0}, 0.105, 0.6 * 300.0 * 0.21, 300.0);
  EXPECT_EQ(sheet.scorchAt({0.0, 0.0}), 0.0);
}

TEST(Scorch, TouchesBoardThatWasNotBurnt) {
  BoardDescription board = scorchingBoard();
  board.scorch.shift_mm = {0.8, 0.0};
  Sheet sheet(board);
  cutLine(sheet, {0.0, -2.0}, {0.0, 2.0}, 0.105, 0.3 * 300.0 * 0.21, 300.0);
  EXPECT_FALSE(sheet.untouched({0.75, 0.0}, {0.85, 0.1}));
  EXPECT_FALSE(sheet.untouched({-0.05, 0.0}, {0.05, 0.1}));
  EXPECT_TRUE(sheet.untouched({0.35, 0.0}, {0.45, 0.1}));
  EXPECT_TRUE(sheet.untouched({-0.85, 0.0}, {-0.75, 0.1}));
  board.scorch.darkening = 0.0;  // The board is scorched invisibly.
  Sheet invisible(board);
  cutLine(invisible, {0.0, -2.0}, {0.0, 2.0}, 0.105, 0.3 * 300.0 * 0.21, 300.0);
  EXPECT_TRUE(invisible.untouched({0.75, 0.0}, {0.85, 0.1}));
}

TEST(BoardDescription, AllFaultsAreNamedAtOnce) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  BoardDescription board;
  EXPECT_EQ(faultsOf(board), "");
  EXPECT_EQ(faultsOf(experimentalBoard()), "");
  EXPECT_EQ(faultsOf(scorchingBoard()), "");
  board.thickness_mm = nan;
  board.cut_fluence_j_mm2 = 0.0;
  board.depth_curve = {{0.1, 0.0}, {0.5, 0.5}, {0.5, 0.8}, {1.0, 1.0}};
  board.transmission = 1.0;
  board.print_transmission = nan;
  board.scorch = {.fluence_j_mm2 = -1.0, .darkening = 1.1, .shift_mm = {0.0, 1.5}};
  const std::string faults = faultsOf(board);
  for (const char* name : {"thickness_mm", "cut_fluence_j_mm2", "depth_curve", " transmission",
                           "print_transmission", "scorch.fluence_j_mm2", "darkening", "shift_mm"}) {
    EXPECT_NE(faults.find(name), std::string::npos) << name;
  }
  EXPECT_THROW(Sheet{board}, std::invalid_argument);
}

TEST(BoardDescription, ADepthCurveMustAscendFromZeroToOne) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto faulty = [](std::vector<DepthPoint> curve) {
    BoardDescription board;
    board.depth_curve = std::move(curve);
    return !faultsOf(board).empty();
  };
  EXPECT_FALSE(faulty({{0.2, 0.0}, {1.0, 1.0}}));
  EXPECT_TRUE(faulty({{1.0, 1.0}}));
  EXPECT_TRUE(faulty({{0.2, 0.1}, {1.0, 1.0}}));
  EXPECT_TRUE(faulty({{-0.2, 0.0}, {1.0, 1.0}}));
  EXPECT_TRUE(faulty({{0.2, 0.0}, {1.0, 0.9}}));
  EXPECT_TRUE(faulty({{0.2, 0.0}, {0.9, 1.0}}));
  EXPECT_TRUE(faulty({{0.2, 0.0}, {0.5, 0.6}, {0.7, 0.6}, {1.0, 1.0}}));
  EXPECT_TRUE(faulty({{0.2, 0.0}, {nan, 0.6}, {1.0, 1.0}}));
  EXPECT_TRUE(faulty({{0.2, 0.0}, {0.5, nan}, {1.0, 1.0}}));
}

}  // namespace
}  // namespace kerfbench::twin
