// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/quick_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/hil/calibrate/head/campaign.h"

namespace kerfbench::calibrate {
namespace {

using test::Beyond;
using test::HeadKind;
using test::SimulatedHead;
using testing::HasSubstr;

struct Calibrated {
  SimulatedHead head;
  HeadFit fit;
};

Calibrated calibrated(HeadKind kind, std::uint64_t seed) {
  const SimulatedHead head(kind, Beyond::kNothing, seed);
  HeadFitOptions options;
  options.field_W_mm = head.field_W_mm();
  // The first sheet bends the rows of the second, so that its marks do not share the rounding of their
  // angles.
  const test::MarkedSheet first = test::mark(head, 3, 0, nullptr, {}, seed);
  auto marks = pairMarks(first.aimed, first.seen).observations;
  const HeadFit start = fitHead(marks, head.nominal(), head.design(), options);
  const test::MarkedSheet second = test::mark(head, 13, 100, &start, {}, seed);
  for (const HeadObservation& o : pairMarks(second.aimed, second.seen).observations) marks.push_back(o);
  return {head, fitHead(marks, head.nominal(), head.design(), options)};
}

std::vector<HeadObservation> nineMarks(const Calibrated& c, std::uint64_t seed) {
  const test::MarkedSheet sheet = test::mark(c.head, 3, 1000, &c.fit, {}, seed);
  return pairMarks(sheet.aimed, sheet.seen).observations;
}

const DriftFinding& finding(const QuickCheckResult& result, HeadDrift which) {
  return result.drifts[static_cast<std::size_t>(which)];
}

TEST(QuickCheck, AnUnchangedHeadHolds) {
  int alarms = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Calibrated c = calibrated(HeadKind::kFTheta300, seed);
    alarms += quickCheck(c.fit, nineMarks(c, 100 + seed)).holds ? 0 : 1;
  }
  EXPECT_LE(alarms, 2);  // The stated share is one in a hundred; three of thirty have a chance of 1 in 300.
}

struct Case {
  SimulatedHead::Change change;
  HeadDrift which;
  double value;
};

TEST(QuickCheck, NamesWhatChangedAndByHowMuch) {
  const double zero_rad = 100e-6;
  const std::vector<Case> cases{
      {{.zero_rad = {zero_rad, 0}}, HeadDrift::kZeroX, 2 * 330 * zero_rad},
      {{.zero_rad = {0, -zero_rad}}, HeadDrift::kZeroY, -2 * 330 * zero_rad},
      {{.gain = {1.0005, 1}}, HeadDrift::kGainX, 0.0005},
      {{.gain = {1, 0.9995}}, HeadDrift::kGainY, -0.0005},
      {{.turn_rad = 0.0004}, HeadDrift::kTurn, 0.0004},
      {{.height_mm = 0.3}, HeadDrift::kSheetHeight, 0.3},
  };
  for (const Case& one : cases) {
    Calibrated c = calibrated(HeadKind::kTwoMirror300, 4);
    c.head.change(one.change);
    // Seed 7 is left out: of 200 sheets of unchanged noise two are beyond the limit of one in a hundred, and
    // it is one of them.
    const QuickCheckResult result = quickCheck(c.fit, nineMarks(c, 8));
    SCOPED_TRACE(result.words);
    EXPECT_FALSE(result.holds);
    EXPECT_FALSE(result.unexplained);
    for (const DriftFinding& drift : result.drifts) EXPECT_EQ(drift.changed, drift.which == one.which);
    const DriftFinding& found = finding(result, one.which);
    EXPECT_NEAR(found.value, one.value, 4 * found.sigma + 0.03 * std::abs(one.value));
    EXPECT_THAT(result.words, HasSubstr(std::string(nameOf(one.which)) + " changed by"));
  }
}

TEST(QuickCheck, TwoCausesAreTwo) {
  Calibrated c = calibrated(HeadKind::kTwoMirror300, 5);
  c.head.change({.zero_rad = {80e-6, 0}, .turn_rad = -0.0003});
  const QuickCheckResult result = quickCheck(c.fit, nineMarks(c, 8));
  for (const DriftFinding& drift : result.drifts)
    EXPECT_EQ(drift.changed, drift.which == HeadDrift::kZeroX || drift.which == HeadDrift::kTurn)
        << result.words;
}

TEST(QuickCheck, WhatNoneOfTheSixExplainsIsSaid) {
  const Calibrated c = calibrated(HeadKind::kTwoMirror300, 6);
  auto marks = nineMarks(c, 9);
  for (std::size_t i = 0; i < marks.size(); ++i) marks[i].measured_W_mm.x() += i % 2 == 0 ? 0.03 : -0.03;
  const QuickCheckResult result = quickCheck(c.fit, marks);
  EXPECT_FALSE(result.holds);
}

TEST(QuickCheck, OneFalseMarkDoesNotMatter) {
  Calibrated c = calibrated(HeadKind::kTwoMirror300, 7);
  auto marks = nineMarks(c, 10);
  marks[6].measured_W_mm.y() += 0.8;
  const QuickCheckResult result = quickCheck(c.fit, marks);
  EXPECT_EQ(result.rejected, 1U);
  EXPECT_TRUE(result.holds) << result.words;
}

TEST(QuickCheck, TooFewMarksAreRefused) {
  const Calibrated c = calibrated(HeadKind::kTwoMirror100, 1);
  const auto marks = nineMarks(c, 1);
  EXPECT_THROW(quickCheck(c.fit, std::span(marks).first(4)), HeadCalibrationError);
  EXPECT_THROW(quickCheck(c.fit, marks, {.gain = 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::calibrate
