// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/power/loop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "libraries.h"

namespace kerfbench::planner {
namespace {

constexpr PowerLimits kLimits{4.0, 78.0};

bool inside(double power_w) { return power_w >= kLimits.least_w && power_w <= kLimits.most_w; }

/// Remaining error of a step after some periods, of a tube that makes `tube_gain` times what it should.
double errorAfter(int periods, double tube_gain, double wanted_w, double loop_gain, int late) {
  std::vector<double> commanded{wanted_w};
  for (int k = 0; k < periods; ++k) {
    const std::size_t seen = commanded.size() - 1 - std::min(commanded.size() - 1, std::size_t(late));
    commanded.push_back(
        nextPower(commanded.back(), wanted_w, tube_gain * commanded[seen], kLimits, loop_gain));
  }
  return std::abs(tube_gain * commanded.back() - wanted_w);
}

TEST(PowerLoop, SettlesForTubesWithin20PercentAndNeverLeavesTheLimits) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> gains(0.8, 1.2);
  std::uniform_real_distribution<double> powers(kLimits.least_w * 1.25, kLimits.most_w * 0.8);
  for (int i = 0; i < 5000; ++i) {
    const double gain = gains(random);
    const double wanted = powers(random);
    double power = std::uniform_real_distribution<double>(kLimits.least_w, kLimits.most_w)(random);
    double error = std::abs(gain * power - wanted);
    for (int k = 0; k < 12; ++k) {
      power = nextPower(power, wanted, gain * power, kLimits);
      ASSERT_TRUE(inside(power));
      const double now = std::abs(gain * power - wanted);
      ASSERT_LE(now, 0.2 * error + 1e-12) << "gain " << gain << ", wanted " << wanted << ", period " << k;
      error = now;
    }
    EXPECT_LT(error, 1e-5);
  }
}

// A tube whose curve is bent, not only scaled: its slope is within 20 % of the library's everywhere.
TEST(PowerLoop, SettlesOnATubeWithAnotherCurveThanTheLibrarys) {
  const LaserTube library = test::tube();
  std::mt19937_64 random(4);
  for (int i = 0; i < 200; ++i) {
    std::uniform_real_distribution<double> scales(0.8, 1.2);
    std::vector<Curve::Point> bent{{library.power.least().x, library.power.least().y * scales(random)}};
    for (std::size_t k = 1; k < library.power.points().size(); ++k) {
      const auto& p = library.power.points();
      bent.push_back({p[k].x, bent.back().y + (p[k].y - p[k - 1].y) * scales(random)});
    }
    const Curve truth(bent);
    const double wanted = std::uniform_real_distribution<double>(8.0, 60.0)(random);
    double power = wanted;
    const auto measured = [&] { return truth.at(library.power.inverse(power).value()); };
    for (int k = 0; k < 12; ++k) power = nextPower(power, wanted, measured(), kLimits);
    EXPECT_NEAR(measured(), wanted, 1e-6);
  }
}

TEST(PowerLoop, FollowsAChangingDemandAsClosely) {
  const double gain = 0.85;
  double power = 40.0;
  double wanted = 40.0;
  for (int k = 0; k < 400; ++k) {
    const double step = 25.0 * (std::sin(0.02 * (k + 1)) - std::sin(0.02 * k));
    const double error = gain * power - wanted;
    wanted += step;
    power = nextPower(power, wanted, gain * power, kLimits);
    // The error that remains is the tube's share of the newest step alone, and 15 % of the error before.
    ASSERT_NEAR(gain * power - wanted, (1.0 - gain) * (error - step), 1e-9);
  }
}

TEST(PowerLoop, DoesNotWindUpAtALimit) {
  for (const double gain : {0.8, 1.0, 1.2}) {
    for (const double unreachable : {500.0, 0.0}) {
      double power = 30.0;
      for (int k = 0; k < 10000; ++k) power = nextPower(power, unreachable, gain * power, kLimits);
      EXPECT_TRUE(inside(power));
      double fresh = 30.0;
      for (int k = 0; k < 12; ++k) {
        power = nextPower(power, 30.0, gain * power, kLimits);
        fresh = nextPower(fresh, 30.0, gain * fresh, kLimits);
      }
      EXPECT_NEAR(gain * power, 30.0, 1e-5);
      EXPECT_NEAR(power, fresh, 1e-5);
    }
  }
}

TEST(PowerLoop, StaysWithinTheLimitsWhateverItIsTold) {
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double odd[] = {nan, inf, -inf, -1.0, 0.0, 1e308, -1e308, 5e-324, 40.0};
  for (const double power : odd)
    for (const double wanted : odd)
      for (const double measured : odd)
        EXPECT_TRUE(inside(nextPower(power, wanted, measured, kLimits)))
            << power << ' ' << wanted << ' ' << measured;
}

TEST(PowerLoop, RunsOpenWithoutAMeasurement) {
  for (const double none : {std::numeric_limits<double>::quiet_NaN(), -0.5})
    EXPECT_EQ(nextPower(70.0, 33.0, none, kLimits), 33.0);
}

TEST(PowerLoop, AMeasurementOfThePeriodBeforeNeedsALowerGain) {
  EXPECT_LT(errorAfter(60, 1.1, 40.0, 1.0, 0), 1e-9);
  EXPECT_GT(errorAfter(60, 1.1, 40.0, 1.0, 1), 1.0) << "gain 1 rings";
  for (const double gain : {0.8, 0.9, 1.0, 1.1, 1.2})
    EXPECT_LT(errorAfter(60, gain, 40.0, 0.4, 1), 1e-6) << gain;
}

// The PWM has steps: the power alternates between the two next to the wanted one, and its mean is exact.
TEST(PowerLoop, ThroughThePwmItsMeanIsExact) {
  const auto model = test::steelModel(0.2);
  std::mt19937_64 random(6);
  for (int i = 0; i < 200; ++i) {
    const double gain = std::uniform_real_distribution<double>(0.8, 1.2)(random);
    const double wanted = std::uniform_real_distribution<double>(8.0, 60.0)(random);
    double power = wanted;
    double sum_w = 0.0;
    constexpr int kPeriods = 500;
    for (int k = 0; k < kPeriods; ++k) {
      const std::uint8_t byte = model->byteFor(model->laser().power.inverse(power).value());
      const double made_w = gain * model->powerOf(byte);
      if (k >= 20) {
        const double step_w = gain * (model->powerOf(std::uint8_t(byte + 1)) - model->powerOf(byte));
        EXPECT_NEAR(made_w, wanted, 2.0 * step_w);
      }
      sum_w += made_w;
      power = nextPower(power, wanted, made_w, kLimits);
    }
    // The sum of all errors is the change of the power, and the first period's error.
    EXPECT_NEAR(sum_w / kPeriods, wanted, 20.0 / kPeriods);
  }
}

// Noise of the measurement passes through, amplified by no more than 1 / (1 - |1 - G|).
TEST(PowerLoop, NoiseOfTheMeasurementStaysBounded) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> noise(-0.5, 0.5);
  for (const double gain : {0.8, 1.0, 1.2}) {
    double power = 40.0 / gain;
    double worst = 0.0;
    for (int k = 0; k < 5000; ++k) {
      power = nextPower(power, 40.0, gain * power + noise(random), kLimits);
      worst = std::max(worst, std::abs(gain * power - 40.0));
    }
    EXPECT_LE(worst, gain * 0.5 / (1.0 - std::abs(1.0 - gain)) + 1e-9);
  }
}

/// Powers of a contour of short lines: up and down between 11 and 55 W within 20 ms, and even for as long.
std::vector<double> braking() {
  std::vector<double> wanted_w;
  for (int k = 0; k < 600; ++k) {
    const int phase = k % 50;
    wanted_w.push_back(phase < 25 ? 11.0 + 3.667 * std::abs(12 - std::min(phase, 24)) : 55.0);
  }
  return wanted_w;
}

double worstOf(double tube, int late, double gain, LoopLaw law) {
  const std::vector<double> shares = loopCourse(braking(), tube, late, gain, law, {1.0, 500.0});
  double worst = 0.0;
  for (std::size_t k = 100; k < shares.size(); ++k) worst = std::max(worst, std::abs(shares[k] - 1.0));
  return worst;
}

/// Wang, Li, Chen 2010, figure 3, as written: it holds where P_f is that of P(k), and rings for ever where it
/// is periods late. In shares of P_out with the damped gain a late measurement does no harm on ramps either.
TEST(PowerLoop, ThePapersLawNeedsAMeasurementOfTheSamePeriod) {
  EXPECT_LT(worstOf(0.95, 0, 1.0, LoopLaw::kWatts), 0.02);
  EXPECT_GT(worstOf(0.95, 3, 1.0, LoopLaw::kWatts), 1.0);
  for (const int late : {0, 1, 3, 5}) {
    EXPECT_LT(worstOf(0.95, late, dampedGain(late), LoopLaw::kShares), 0.002) << late;
    EXPECT_LT(worstOf(1.2, late, dampedGain(late), LoopLaw::kShares), 0.005) << late;
  }
  EXPECT_GT(worstOf(0.95, 3, dampedGain(3), LoopLaw::kWatts), 0.05)
      << "what is learnt in watts fails on ramps";
}

/// An integrator with gain g behind n periods rings for ever from 2 sin(pi / (2 (2 n + 1))) on.
TEST(PowerLoop, RingsFromTwoAndAHalfTimesItsGainOn) {
  const std::vector<double> even(4000, 50.0);
  for (const int late : {0, 1, 2, 4, 7}) {
    const double limit = 2.5 * dampedGain(late);
    const auto last = [&](double gain) {
      const std::vector<double> shares =
          loopCourse(even, 0.95, late, gain / 0.95, LoopLaw::kShares, {0.1, 1e9});
      double most = 0.0;
      for (std::size_t k = shares.size() - 60; k < shares.size(); ++k)
        most = std::max(most, std::abs(shares[k] - 1.0));
      return most;
    };
    EXPECT_LT(last(0.98 * limit), 0.02) << late;
    EXPECT_GT(last(1.02 * limit), 0.05) << late;
  }
}

}  // namespace
}  // namespace kerfbench::planner
