// SPDX-License-Identifier: Apache-2.0
// The head against displacements that were worked out by hand.
#include "twin/five_axis/five_axis_head.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

namespace kerfbench::twin {
namespace {

using Eigen::Vector3d;

constexpr double kRight_rad = 0.5 * std::numbers::pi;
constexpr double kTenth_rad = 0.1 * std::numbers::pi / 180.0;

/// Steps so small that rounding does not count.
FiveAxisDescription fineHead() {
  FiveAxisDescription head;
  head.pivot_mm = 120.0;
  head.linear_step_mm = 1e-6;
  head.turn_step_rad = 1e-9;
  return head;
}

FiveAxisBeam beamOf(const FiveAxisDescription& head, const FiveAxisPose& pose) {
  return FiveAxisHead(head).moveTo(pose);
}

const Vector3d kPlace_mm(40.0, 45.0, -9.0);
const FiveAxisPose kLyingDown{kPlace_mm, kRight_rad, kRight_rad};

TEST(FiveAxisHead, ItsAxisIsThatOfTheProgramsConvention) {
  EXPECT_LT((FiveAxisHead::axisOf(0.0, 1.0) - Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_LT((FiveAxisHead::axisOf(kRight_rad, kRight_rad) - Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_LT((FiveAxisHead::axisOf(kRight_rad, 2.0 * kRight_rad) - Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_LT((FiveAxisHead::axisOf(kRight_rad, 0.0) + Vector3d::UnitY()).norm(), 1e-12);
}

TEST(FiveAxisHead, WithoutErrorsItsFocusIsWhereTheProgramWantsIt) {
  for (const double a_rad : {0.0, 0.4, 1.1, kRight_rad}) {
    for (const double c_rad : {-3.0, 0.0, 2.0, 9.0}) {
      const FiveAxisBeam beam = beamOf(fineHead(), {kPlace_mm, a_rad, c_rad});
      EXPECT_LT((beam.p_WQ_mm - kPlace_mm).norm(), 3e-6);
      EXPECT_LT((beam.axis_W - FiveAxisHead::axisOf(a_rad, c_rad)).norm(), 1e-8);
    }
  }
}

TEST(FiveAxisHead, WhatAPivotsLengthIsWrongTheTouchOffHidesUprightAndNotLyingDown) {
  FiveAxisDescription head = fineHead();
  head.errors.pivot_mm = 0.2;
  EXPECT_LT((beamOf(head, {kPlace_mm, 0.0, 0.0}).p_WQ_mm - kPlace_mm).norm(), 1e-5);
  // 0.2 mm too far out along -x, and lifted by the 0.2 mm that were touched off.
  const Vector3d off = beamOf(head, kLyingDown).p_WQ_mm - kPlace_mm;
  EXPECT_LT((off - Vector3d(-0.2, 0.0, 0.2)).norm(), 1e-5);
}

TEST(FiveAxisHead, AZeroOfAShiftsByTheLeverOfThePivot) {
  FiveAxisDescription head = fineHead();
  head.errors.a_zero_rad = kTenth_rad;
  EXPECT_LT((beamOf(head, {kPlace_mm, 0.0, 0.0}).p_WQ_mm - kPlace_mm).norm(), 1e-5);
  // Turned about Wy by e: +z by L sin e at A = 90, C = 90; upright -L (0, -sin e, cos e - 1) was touched off.
  const double lever_mm = 120.0 * std::sin(kTenth_rad);
  const double lift_mm = 120.0 * (1.0 - std::cos(kTenth_rad));
  const Vector3d off = beamOf(head, kLyingDown).p_WQ_mm - kPlace_mm;
  EXPECT_LT((off - Vector3d(lift_mm, -lever_mm, lever_mm - lift_mm)).norm(), 1e-5);
}

TEST(FiveAxisHead, AZeroOfCShiftsOnlyAHeadThatLeans) {
  FiveAxisDescription head = fineHead();
  head.errors.c_zero_rad = kTenth_rad;
  EXPECT_LT((beamOf(head, {kPlace_mm, 0.0, 0.0}).p_WQ_mm - kPlace_mm).norm(), 1e-5);
  const Vector3d off = beamOf(head, kLyingDown).p_WQ_mm - kPlace_mm;
  EXPECT_NEAR(off.y(), -120.0 * std::sin(kTenth_rad), 1e-5);
  EXPECT_NEAR(off.z(), 0.0, 1e-5);
}

TEST(FiveAxisHead, PlayShowsAsTheDifferenceOfBothWays) {
  FiveAxisDescription head = fineHead();
  head.errors.a_backlash_rad = kTenth_rad;
  FiveAxisHead from_below(head);
  FiveAxisHead from_above(head);
  from_below.moveTo({kPlace_mm, 0.5, 0.0});
  from_above.moveTo({kPlace_mm, 1.5, 0.0});
  const Vector3d below = from_below.moveTo({kPlace_mm, 1.0, 0.0}).p_WQ_mm;
  const Vector3d above = from_above.moveTo({kPlace_mm, 1.0, 0.0}).p_WQ_mm;
  EXPECT_NEAR((below - above).norm(), 2.0 * 120.0 * std::sin(0.5 * kTenth_rad), 1e-5);
}

TEST(FiveAxisHead, ALeaningYMovesXByTheWayAlongY) {
  FiveAxisDescription head = fineHead();
  head.errors.squareness_rad = 1e-3;
  const Vector3d off = beamOf(head, {kPlace_mm, 0.0, 0.0}).p_WQ_mm - kPlace_mm;
  EXPECT_LT((off - Vector3d(0.045, 0.0, 0.0)).norm(), 1e-5);
}

TEST(FiveAxisHead, AxesStandOnWholeSteps) {
  FiveAxisDescription head = fineHead();
  head.linear_step_mm = 0.01;
  head.turn_step_rad = 0.001;
  const FiveAxisPlaces places = FiveAxisHead(head).placesFor({kPlace_mm, 0.7004, 0.3006});
  EXPECT_DOUBLE_EQ(places.a_rad, 0.7);
  EXPECT_DOUBLE_EQ(places.c_rad, 0.301);
  for (const double p : {places.pivot_mm.x(), places.pivot_mm.y(), places.pivot_mm.z()})
    EXPECT_NEAR(p / 0.01, std::round(p / 0.01), 1e-9);
}

TEST(FiveAxisHead, RefusesWhatIsNoHeadWithEveryFault) {
  FiveAxisDescription head = fineHead();
  head.pivot_mm = 0.0;
  head.errors.a_zero_rad = std::numeric_limits<double>::quiet_NaN();
  const std::string faults = faultsOf(head);
  EXPECT_NE(faults.find("pivot_mm"), std::string::npos);
  EXPECT_NE(faults.find("a_zero_rad"), std::string::npos);
  EXPECT_THROW(FiveAxisHead{head}, std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::twin
