// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/twin/cutter/machines.h"

namespace kerfbench::twin {
namespace {

constexpr Tick kQuantum = 8000;

TEST(TwinSensors, TheInterlockClosesOnceAtTheStart) {
  Twin twin(twoMirror(), lineWeb(), kRate);
  std::vector<SensorEdge> interlock;
  run(twin, {}, 0, ticks(0.1), kQuantum, [&](Tick, Tick, const auto& edges) {
    for (const SensorEdge& e : edges) {
      if (e.signal == Signal::kInterlock) interlock.push_back(e);
    }
  });
  ASSERT_EQ(interlock.size(), 1U);
  EXPECT_EQ(interlock[0].tick, 1U);
  EXPECT_TRUE(interlock[0].level);
}

TEST(TwinSensors, EdgesLieInTheirQuantumInOrder) {
  const auto machine = gantry();
  Pins pins(machine.signals);
  pins.steps(Signal::kGantryXPul, 1e-3, 300, 150e-6, true);
  Twin twin(machine, lineWeb(), kRate);
  run(twin, pins.events(), 0, ticks(0.2), 1237, [&](Tick from, Tick until, const auto& edges) {
    EXPECT_TRUE(std::ranges::is_sorted(edges, {}, &SensorEdge::tick));
    for (const SensorEdge& e : edges) {
      EXPECT_GT(e.tick, from);
      EXPECT_LE(e.tick, until);
    }
  });
}

TEST(TwinSensors, TheEncoderOfASteadyBeltIsEvenToATick) {
  Twin twin(twoMirror(), lineWeb(), kRate, {.fidelity = Fidelity::kFast});
  QuadratureCounter counter;
  run(twin, {}, 0, ticks(0.3), kQuantum, [&](Tick, Tick, const auto& edges) {
    for (const SensorEdge& e : edges) {
      if (e.signal != Signal::kEncoderA && e.signal != Signal::kEncoderB) continue;
      counter.apply(e);
      const double exact = static_cast<double>(counter.count()) * 0.01 / 60.0 * 16e6;
      EXPECT_NEAR(static_cast<double>(e.tick), exact, 1.01);
    }
  });
  EXPECT_EQ(counter.count(), 1800 - 1 + (twin.truth().belt_travel_mm >= 18.0 ? 1 : 0));
  EXPECT_EQ(counter.illegal(), 0);
}

TEST(TwinSensors, TheEncoderFollowsABeltThatIsFedThereAndBack) {
  const auto machine = twoMirror();
  Pins pins(machine.signals);
  const double turn_s = pins.steps(Signal::kFeedPul, 1e-3, 1000, 120e-6, true);
  const double end_s = pins.steps(Signal::kFeedPul, turn_s + 20e-3, 1503, 150e-6, false);
  Twin twin(machine, fedWeb(), kRate, {.fidelity = Fidelity::kFast});
  QuadratureCounter counter;
  double worst = 0.0;
  run(twin, pins.events(), 0, ticks(end_s + 0.1), kQuantum, [&](Tick, Tick, const auto& edges) {
    for (const SensorEdge& e : edges) counter.apply(e);
    const double travel = twin.pose().roller_mm / 0.01;
    worst = std::max(worst, std::abs(travel - 0.5 - static_cast<double>(counter.count())));
  });
  EXPECT_LT(worst, 0.75);  // Half a count is resolution; the rest is the forecast's error.
  EXPECT_EQ(counter.count(), static_cast<long long>(std::floor(-503 * kTravelStepMm / 0.01)));
  EXPECT_EQ(counter.illegal(), 0);
}

TEST(TwinSensors, TheEyeMarksComeWhereThePrintSaysTheyAre) {
  Twin twin(twoMirror(), lineWeb(), kRate, {.fidelity = Fidelity::kFast});
  std::vector<SensorEdge> marks;
  run(twin, {}, 0, ticks(2.0), kQuantum, [&](Tick, Tick, const auto& edges) {
    for (const SensorEdge& e : edges) {
      if (e.signal == Signal::kPrintMark) marks.push_back(e);
    }
  });
  ASSERT_EQ(marks.size(), 6U);
  for (std::size_t i = 0; i < marks.size(); ++i) {
    // Unit k's leading edge is at start + 4 - 50 k on the web; the sensor is at -150.
    const double leading_mm = -150.0 - (-157.0 + 4.0 - 50.0 * static_cast<double>(i / 2));
    const double at_mm = leading_mm + (i % 2 == 0 ? 0.0 : 4.0);
    EXPECT_EQ(marks[i].level, i % 2 == 0);
    EXPECT_NEAR(static_cast<double>(marks[i].tick), at_mm / 60.0 * 16e6, 1.01);
  }
}

TEST(TwinSensors, LimitsTripBeyondTheTravelAndReleaseOnTheWayBack) {
  const auto machine = gantry();
  Pins pins(machine.signals);
  // The axis goes to 3 mm; the limit is at 2.
  const double turn_s = pins.steps(Signal::kGantryXPul, 1e-3, 240, 300e-6, true);
  // The axis goes to -3 mm.
  const double low_s = pins.steps(Signal::kGantryXPul, turn_s + 0.05, 480, 300e-6, false);
  pins.steps(Signal::kGantryYPul, low_s, 100, 300e-6, true);  // The axis goes to 1.25 mm: within.
  Twin twin(machine, lineWeb(), kRate);
  std::vector<SensorEdge> limits;
  std::vector<double> places;
  double before = 0.0;
  run(twin, pins.events(), 0, ticks(low_s + 0.1), kQuantum, [&](Tick from, Tick until, const auto& edges) {
    const double after = twin.pose().gantry_mm.x();
    for (const SensorEdge& e : edges) {
      EXPECT_NE(e.signal, Signal::kLimitY);
      if (e.signal != Signal::kLimitX) continue;
      limits.push_back(e);
      const double share = static_cast<double>(e.tick - from) / static_cast<double>(until - from);
      places.push_back(before + share * (after - before));
    }
    before = after;
  });
  ASSERT_EQ(limits.size(), 3U);
  EXPECT_TRUE(limits[0].level);
  EXPECT_FALSE(limits[1].level);
  EXPECT_TRUE(limits[2].level);
  // The gantry moves by 21 um in a quantum; the remaining error is its jerk in one, from pulse to pulse.
  EXPECT_NEAR(places[0], 2.0, 0.002);
  EXPECT_NEAR(places[1], 2.0, 0.002);
  EXPECT_NEAR(places[2], -2.0, 0.002);
}

TEST(TwinSensors, AMachineWithMirrorsHasNoLimits) {
  const auto machine = twoMirror();
  Pins pins(machine.signals);
  pins.steps(Signal::kGalvoXPul, 1e-3, 3000, 20e-6, true);
  Twin twin(machine, lineWeb(), kRate);
  run(twin, pins.events(), 0, ticks(0.1), kQuantum, [&](Tick, Tick, const auto& edges) {
    for (const SensorEdge& e : edges) EXPECT_TRUE(e.signal != Signal::kLimitX && e.signal != Signal::kLimitY);
  });
}

}  // namespace
}  // namespace kerfbench::twin
