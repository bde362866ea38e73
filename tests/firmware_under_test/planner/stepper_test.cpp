// SPDX-License-Identifier: Apache-2.0
// Steps for steppers, against a rotor integrated by itself: torques of field and magnets, pulses as the
// firmware's accumulator gives them.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "firmware_under_test/planner/head/stepper.h"

namespace kerfbench::planner {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kPeriodS = 0.8e-3;
constexpr int kTicks = 32;
// Motor and gearbox of two-mirror-geared.yaml.
constexpr double kTeeth = 50.0;
constexpr double kHoldingNm = 0.98;
constexpr double kDetentNm = 0.03;
constexpr double kInertiaKgM2 = 3.37e-5;
constexpr double kDampingNmS = 5.5e-3;
constexpr double kSubdivision = 64.0;
constexpr double kStepRad = kTurn / (4.0 * kTeeth * kSubdivision);
const StepperMotors kMotors{kSubdivision, kDetentNm / kHoldingNm, 191.9, 0.0677};
constexpr StepSource kSource{kPeriodS, kTicks, 31, kDampingNmS / (kHoldingNm * kTeeth)};

/// Rotor in its field, with or without the magnets' pull.
struct Rotor {
  double detent_nm{};
  double q{}, v{};
  void run(double command, double time_s) {
    constexpr double kStepS = 5e-6;
    const auto force = [&](double angle, double speed) {
      return (-kHoldingNm * std::sin(kTeeth * (angle - command)) -
              detent_nm * std::sin(4.0 * kTeeth * angle) - kDampingNmS * speed) /
             kInertiaKgM2;
    };
    for (double left = time_s; left > 1e-12; left -= kStepS) {
      const double h = std::min(left, kStepS);
      const double middle_q = q + 0.5 * h * v;
      const double middle_v = v + 0.5 * h * force(q, v);
      q += h * middle_v;
      v += h * force(middle_q, middle_v);
    }
  }
};

/// Largest and mean distance of the rotor from the wanted places a delay ago, steps, from the second half
/// second on.
struct Distance {
  double worst{}, rms{};
};

Distance followed(const std::vector<double>& places, const std::vector<int>& positions, double detent_nm) {
  Rotor rotor{detent_nm};
  int at = 0;
  Distance d;
  double count = 0.0;
  for (std::size_t k = 0; k < positions.size(); ++k) {
    const int steps = positions[k] - at;
    unsigned sum = 128;
    for (int tick = 1; tick <= kTicks; ++tick) {
      rotor.run(at * kStepRad, kPeriodS / kTicks);
      sum += static_cast<unsigned>(std::abs(steps)) * 256U / kTicks;
      if (sum >= 256U) at += steps > 0 ? 1 : -1;
      sum %= 256U;
      if (k < 625 || k + 1 == positions.size()) continue;
      const double ago = static_cast<double>(tick) / kTicks - kSource.delay_s / kPeriodS;
      const double wanted = ago >= 0.0 ? places[k - 1] + ago * (places[k] - places[k - 1])
                                       : places[k - 1] + ago * (places[k - 1] - places[k - 2]);
      const double off = rotor.q / kStepRad - wanted;
      d.worst = std::max(d.worst, std::abs(off));
      d.rms += off * off;
      ++count;
    }
  }
  d.rms = std::sqrt(d.rms / count);
  return d;
}

/// An even way of so many steps in a period, after a ramp of half a second.
std::vector<double> evenWay(double steps) {
  std::vector<double> places;
  double at = 0.0;
  for (int k = 1; k <= 1500; ++k) places.push_back(at += steps * std::min(1.0, k / 625.0));
  return places;
}

std::vector<int> nearest(const std::vector<double>& places) {
  std::vector<int> steps;
  for (const double place : places) steps.push_back(static_cast<int>(std::lround(place)));
  return steps;
}

std::vector<double> against(const std::vector<double>& places) {
  std::vector<double> commands;
  for (const double place : places) commands.push_back(againstDetent(place, kMotors));
  return commands;
}

TEST(AgainstDetent, TheRotorStandsWhereItIsWanted) {
  for (const double wanted : {0.0, 3.0, 8.0, 16.0, 27.3, 32.0, 50.0, 70.5, -20.0, -1234.6}) {
    Rotor rotor{kDetentNm, wanted * kStepRad};
    rotor.run(againstDetent(wanted, kMotors) * kStepRad, 0.2);
    EXPECT_NEAR(rotor.q / kStepRad, wanted, 1e-3) << wanted;
  }
  EXPECT_NEAR(againstDetent(16.0, kMotors), 16.0 + 1.2474, 1e-3);  // A quarter of a full step: the most.
}

TEST(AgainstDetent, IsNothingForAMotorOfWhichNothingIsKnown) {
  EXPECT_EQ(againstDetent(12.25, {}), 12.25);
  EXPECT_EQ(againstDetent(12.25, {.full_step_pulses = 64}), 12.25);
}

TEST(StepChoice, ThePatternOfRoundedStepsSwingsTheRotorAndTheChosenOneDoesNot) {
  const StepChoice choice(kMotors, kSource);
  // The part of a step that a period has too much, 0.154, comes round 192 times in a second.
  const std::vector<double> way = evenWay(0.846);
  EXPECT_GT(followed(way, nearest(way), 0.0).worst, 1.0);
  for (const double steps : {0.4, 0.55, 0.846, 1.154, 1.9, 3.3}) {
    const std::vector<double> places = evenWay(steps);
    const Distance chosen = followed(places, choice.along(places, 0), 0.0);
    EXPECT_LT(chosen.worst, 0.7) << steps;
    EXPECT_LT(chosen.rms, 0.3) << steps;
  }
}

TEST(StepChoice, HoldsForARotorThatIsATenthFasterOrSlower) {
  const std::vector<double> places = evenWay(0.846);
  for (const double factor : {0.9, 1.1}) {
    StepperMotors other = kMotors;
    other.resonance_hz *= factor;
    EXPECT_LT(followed(places, StepChoice(other, kSource).along(places, 0), 0.0).worst, 0.8) << factor;
  }
}

TEST(StepChoice, WithTheMagnetsAsWellTheRotorFollows) {
  const StepChoice choice(kMotors, kSource);
  for (const double steps : {0.55, 0.846, 1.9}) {
    const std::vector<double> places = evenWay(steps);
    EXPECT_GT(followed(places, choice.along(places, 0), kDetentNm).worst, 1.0) << steps;
    EXPECT_LT(followed(places, choice.along(against(places), 0), kDetentNm).worst, 0.8) << steps;
  }
}

TEST(StepChoice, NoStepGoesBackAndWhatRestsIsLeftAlone) {
  const StepChoice choice(kMotors, kSource);
  std::vector<double> places = evenWay(0.3);
  const double stop = places.back();
  for (int k = 0; k < 300; ++k) places.push_back(stop);
  for (int k = 0; k < 300; ++k) places.push_back(places.back() - 0.7);
  const std::vector<int> chosen = choice.along(places, 0);
  int turns_at_rest = 0;
  for (std::size_t k = 1; k < places.size(); ++k) {
    const int count = chosen[k] - chosen[k - 1];
    EXPECT_LT(std::abs(chosen[k] - places[k]), 2.0) << k;
    if (places[k] > places[k - 1]) EXPECT_GE(count, 0) << k;
    if (places[k] < places[k - 1]) EXPECT_LE(count, 0) << k;
    if (places[k] == places[k - 1] && count != 0) ++turns_at_rest;
  }
  EXPECT_LE(turns_at_rest, 1);
  EXPECT_EQ(chosen.back(), std::lround(places.back()));
}

}  // namespace
}  // namespace kerfbench::planner
