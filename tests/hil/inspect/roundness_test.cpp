// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/deviation/roundness.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "hil/inspect/deviation/worst_deviation.h"

namespace kerfbench::inspect {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kSigma_mm = 0.0002;
constexpr std::size_t kReadings = 140;
constexpr double kWindow_rad = 0.09;

/// A circle read with the white noise of `seed`; `radius` over the share of the circumference, 0 … 1.
struct Circle {
  Circle(const std::function<double(double)>& radius, std::uint64_t seed) {
    const CounterRandom random(seed, 0);
    for (std::size_t i = 0; i < kReadings; ++i) {
      const double share = static_cast<double>(i) / kReadings;
      kind.angle_rad.push_back(kTurn * share);
      line.reading_mm.push_back(radius(share) + kSigma_mm * random.normal(i));
      line.sigma_mm.push_back(kSigma_mm);
      line.caliper.push_back(i);
    }
    kind.is_circle = true;
    line.segment = {0, kReadings};
    line.shared.setZero(kReadings, ReadingLine::kOwn);
  }
  [[nodiscard]] Quantity circularity() const {
    ErrorModel model;
    model.lines = {line};
    return measureDeviations(model, {kind}, 0.05, 1).circularity.at(0);
  }
  ReadingLine line;
  LineKind kind;
};

double coverage(const std::function<double(double)>& radius, double truth_mm) {
  constexpr int kCases = 100;
  int hits = 0;
  for (std::uint64_t seed = 1; seed <= kCases; ++seed) {
    const Quantity q = Circle(radius, seed).circularity();
    if (std::abs(q.value - truth_mm) <= q.U) ++hits;
  }
  return hits / static_cast<double>(kCases);
}

TEST(Roundness, IntervalsHoldTheTruth) {
  // Fewer than 88 of 100 cases at 95.45 % would be unlikely. A perfect circle lies at the edge of the
  // possible: its stated interval covers some per cent less.
  EXPECT_GE(coverage([](double) { return 0.01; }, 0.0), 0.80);
  EXPECT_GE(coverage([](double s) { return 0.02 * std::cos(3.0 * kTurn * s); }, 0.04), 0.88);
  EXPECT_GE(coverage([](double s) { return 0.0015 * std::cos(2.0 * kTurn * s); }, 0.003), 0.88);
}

TEST(Roundness, AWaveIsNotRoundedOff) {
  for (const double waves : {2.0, 5.0, 9.0}) {
    const Circle circle([&](double s) { return 0.05 * std::sin(waves * kTurn * s); }, 7);
    const Roundness round(circle.line, circle.kind.angle_rad, kWindow_rad);
    EXPECT_EQ(round.order(), static_cast<int>(waves));
    EXPECT_NEAR(round.asRead(), 0.1, 0.0005) << waves;
  }
}

TEST(Roundness, SizeAndCentreAreNoMatterOfForm) {
  const Circle circle([](double s) { return 0.3 + 0.2 * std::cos(kTurn * s) - 0.1 * std::sin(kTurn * s); },
                      3);
  const Quantity q = circle.circularity();
  EXPECT_LT(q.value - q.U, 0.0001);
  EXPECT_LT(q.value + q.U, 0.001);
}

TEST(Roundness, AStepWhereTheLineClosesIsSeen) {
  // A ramp s around the circle leaves s - 1/2 + sin(2 pi s) / pi about its least-squares circle: nothing is
  // lost from its range.
  const auto ramp = [](double s) { return 0.01 * s; };
  const Circle circle(ramp, 5);
  const Roundness round(circle.line, circle.kind.angle_rad, kWindow_rad);
  EXPECT_NEAR(round.asRead(), 0.0097, 0.0005);
  EXPECT_GT(round.seamSigma(), 0.0);
}

TEST(Roundness, TheStepIsTheSameWhereverTheLineCloses) {
  const auto readOf = [](double begin_rad) {
    Circle circle([](double s) { return 0.01 * s + 0.01 * s * s; }, 5);
    for (double& angle : circle.kind.angle_rad) angle = std::remainder(angle + begin_rad, kTurn);
    return Roundness(circle.line, circle.kind.angle_rad, kWindow_rad).asRead();
  };
  for (const double begin_rad : {0.25, 0.5, 0.75}) EXPECT_NEAR(readOf(begin_rad * kTurn), readOf(0.0), 1e-4);
}

TEST(Roundness, WhatTheStepHidesWidensItsIntervalByTwoSigmas) {
  // The same noise, so all else of the interval is the same.
  const auto intervalOf = [](double step_mm) {
    const Circle circle([=](double s) { return step_mm * s; }, 5);
    return std::pair{circle.circularity().U,
                     Roundness(circle.line, circle.kind.angle_rad, kWindow_rad).seamSigma()};
  };
  const auto [large_U, large_sigma] = intervalOf(0.08);
  const auto [small_U, small_sigma] = intervalOf(0.04);
  EXPECT_NEAR(std::sqrt(large_U * large_U - small_U * small_U),
              2.0 * std::sqrt(large_sigma * large_sigma - small_sigma * small_sigma), 0.02 * large_U);
}

TEST(Roundness, IsToldOfEightReadingsBesideTheSeamAndNotOfSeven) {
  // The first and the last reading lie at the seam.
  const auto isKnown = [](int inner) {
    ReadingLine line;
    std::vector<double> angle_rad{0.0};
    for (int i = 0; i < inner; ++i) angle_rad.push_back(kTurn / 9.0 * (1.0 + 7.0 * i / (inner - 1.0)));
    angle_rad.push_back(kTurn - 1e-3);
    line.reading_mm.assign(angle_rad.size(), 0.0);
    line.sigma_mm.assign(angle_rad.size(), kSigma_mm);
    line.segment = {0, angle_rad.size()};
    line.shared.setZero(static_cast<Eigen::Index>(angle_rad.size()), ReadingLine::kOwn);
    return Roundness(line, angle_rad, kWindow_rad).isKnown();
  };
  EXPECT_TRUE(isKnown(8));
  EXPECT_FALSE(isKnown(7));
}

TEST(Roundness, OfHalfACircleNothingIsTold) {
  Circle circle([](double) { return 0.0; }, 1);
  for (double& angle : circle.kind.angle_rad) angle *= 0.4;
  EXPECT_FALSE(Roundness(circle.line, circle.kind.angle_rad, kWindow_rad).isKnown());
  EXPECT_TRUE(std::isnan(circle.circularity().value));
}

TEST(Roundness, ReadingsAtTheSeamAreLeftOutWhereverTheCircleBegins) {
  // Three readings of 140 at each end reach over the seam with so wide a window; they show what is not there.
  constexpr double kWide_rad = 0.2;
  for (const double begin_rad : {0.0, 0.25 * kTurn, 0.5 * kTurn, -0.25 * kTurn}) {
    Circle circle([](double) { return 0.0; }, 4);
    for (const std::size_t i : {0U, 1U, 2U, 137U, 138U, 139U}) circle.line.reading_mm[i] += 0.05;
    for (double& angle : circle.kind.angle_rad) angle = std::remainder(angle + begin_rad, kTurn);
    EXPECT_LT(Roundness(circle.line, circle.kind.angle_rad, kWide_rad).asRead(), 0.005) << begin_rad;
  }
}

TEST(Roundness, WhatReadingsStateOfTheirNoiseCountsWhereverTheyLie) {
  constexpr double kWide_rad = 0.2;
  const auto unfittedSigma = [](std::size_t first_loose) {
    Circle circle([](double) { return 0.0; }, 4);
    for (std::size_t i = first_loose; i < first_loose + 6; ++i) circle.line.sigma_mm[i] *= 10.0;
    return Roundness(circle.line, circle.kind.angle_rad, kWide_rad).unfittedSigma();
  };
  // The first and the last three readings, at the seam, take no part.
  EXPECT_NEAR(unfittedSigma(131), unfittedSigma(60), 1e-12);
  EXPECT_NEAR(unfittedSigma(3), unfittedSigma(60), 1e-12);
}

}  // namespace
}  // namespace kerfbench::inspect
