// SPDX-License-Identifier: Apache-2.0
// The twin's state depends on the pin events alone, bit by bit.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/twin/cutter/machines.h"
#include "twin/base/random.h"

namespace kerfbench::twin {
namespace {

constexpr double kEndS = 0.06;

// A controller that jogs all axes at random, breaks every timing rule now and then, and fires the laser.
std::vector<PinEvent> jog(const MachineDescription& machine) {
  const CounterRandom random(21, 4);
  Pins pins(machine.signals);
  const std::vector<Signal> axes =
      machine.kind == MachineDescription::Kind::kGantry
          ? std::vector{Signal::kGantryXPul, Signal::kGantryYPul, Signal::kFeedPul}
          : std::vector{Signal::kGalvoXPul, Signal::kGalvoYPul, Signal::kFeedPul};
  std::uint64_t index = 0;
  for (const Signal pul : axes) {
    const auto dir = static_cast<Signal>(static_cast<std::size_t>(pul) + 1);
    double at_s = 1e-4;
    bool forward = false;
    while (at_s < kEndS - 1e-3) {
      if (random.uniform(index++) < 0.02) {
        forward = !forward;
        pins.set(at_s, dir, forward);
        at_s += 12e-6 * random.uniform(index++);
      }
      pins.set(at_s, pul, true);
      at_s += 1e-6 + 6e-6 * random.uniform(index++);
      pins.set(at_s, pul, false);
      at_s += (pul == Signal::kFeedPul ? 200e-6 : 30e-6) * (0.05 + random.uniform(index++));
    }
  }
  for (int i = 0; i * 64e-6 < kEndS; ++i) {
    pins.set(i * 64e-6, Signal::kLaserPwm, true);
    pins.set((i + 0.1 + 0.8 * random.uniform(index++)) * 64e-6, Signal::kLaserPwm, false);
  }
  for (double at_s = 3e-3; at_s < kEndS; at_s += 7.3e-3) {
    pins.set(at_s, Signal::kLaserGate, true);
    pins.set(at_s + 5.11111e-3, Signal::kLaserGate, false);
  }
  return pins.events();
}

struct Outcome {
  Twin::Truth truth;
  std::vector<float> nodes;
  std::vector<Exposure> exposures;
  std::vector<PulseTiming> timing;
  std::vector<std::pair<double, double>> gates;
};

Outcome outcome(const MachineDescription& machine, const WebDescription& web,
                const std::vector<PinEvent>& events, Tick quantum, bool predict) {
  Twin twin(machine, web, kRate);
  Outcome result;
  const auto collect = [&](Tick, Tick, const std::vector<SensorEdge>&) {
    for (Exposure& e : twin.takeExposures()) result.exposures.push_back(std::move(e));
  };
  run(twin, events, 0, ticks(kEndS), quantum, predict ? QuantumFn(collect) : QuantumFn());
  collect(0, 0, {});
  result.truth = twin.truth();
  constexpr int kColumns = 1200;
  constexpr int kRows = 1200;
  result.nodes.resize(static_cast<std::size_t>(kColumns) * kRows);
  twin.sheet().copyNodes(static_cast<int>(148.0 / Sheet::kCellMm), -kRows / 2, kColumns, kRows, result.nodes);
  result.timing = twin.pulseTiming();
  result.gates = twin.gateIntervals();
  return result;
}

void expectSame(const Outcome& a, const Outcome& b) {
  EXPECT_EQ(a.truth.time_s, b.truth.time_s);
  EXPECT_EQ(a.truth.belt_travel_mm, b.truth.belt_travel_mm);
  EXPECT_EQ(a.truth.emitted_j, b.truth.emitted_j);
  EXPECT_EQ(a.truth.p_WQ_mm, b.truth.p_WQ_mm);
  EXPECT_TRUE(a.nodes == b.nodes);
  EXPECT_EQ(a.gates, b.gates);
  ASSERT_EQ(a.exposures.size(), b.exposures.size());
  for (std::size_t i = 0; i < a.exposures.size(); ++i) {
    EXPECT_EQ(a.exposures[i].sequence, b.exposures[i].sequence);
    EXPECT_EQ(a.exposures[i].start_s, b.exposures[i].start_s);
    ASSERT_EQ(a.exposures[i].samples.size(), b.exposures[i].samples.size());
    for (std::size_t k = 0; k < a.exposures[i].samples.size(); ++k) {
      const ExposureSample& p = a.exposures[i].samples[k];
      const ExposureSample& q = b.exposures[i].samples[k];
      ASSERT_EQ(p.p_WQ_mm, q.p_WQ_mm);
      ASSERT_EQ(p.power_w, q.power_w);
      ASSERT_EQ(p.p_WS_mm, q.p_WS_mm);
    }
  }
  ASSERT_EQ(a.timing.size(), b.timing.size());
  for (std::size_t i = 0; i < a.timing.size(); ++i) {
    EXPECT_EQ(a.timing[i].pulses, b.timing[i].pulses);
    EXPECT_EQ(a.timing[i].setup_histogram, b.timing[i].setup_histogram);
    EXPECT_EQ(a.timing[i].min_hold_s, b.timing[i].min_hold_s);
    EXPECT_EQ(a.timing[i].first_violation_s, b.timing[i].first_violation_s);
  }
}

struct Setup {
  const char* name;
  MachineDescription (*machine)();
  WebDescription (*web)();
};

class TwinQuanta : public testing::TestWithParam<Setup> {};

TEST_P(TwinQuanta, TheEndIsTheSameBitByBitForAnyQuantaWithAndWithoutPrediction) {
  const auto machine = GetParam().machine();
  const auto web = GetParam().web();
  const auto events = jog(machine);
  const Outcome reference = outcome(machine, web, events, ticks(500e-6), false);
  EXPECT_GT(reference.truth.emitted_j, 1.0);
  EXPECT_GT(*std::ranges::max_element(reference.nodes), 0.1F);
  EXPECT_EQ(reference.exposures.size(), 60U);
  EXPECT_GT(reference.timing[0].pulses, 500U);
  EXPECT_GT(reference.timing[0].first_violation_s, 0.0);
  for (const Tick quantum : {ticks(100e-6), ticks(500e-6), ticks(1e-3), Tick{1237}, ticks(kEndS)}) {
    for (const bool predict : {false, true}) {
      SCOPED_TRACE(testing::Message() << quantum << " ticks, prediction " << predict);
      expectSame(outcome(machine, web, events, quantum, predict), reference);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Machines, TwinQuanta,
                         testing::Values(Setup{"MirrorsOnLine", twoMirror, lineWeb},
                                         Setup{"MirrorsFed", twoMirror, fedWeb},
                                         Setup{"GantryOnLine", gantry, lineWeb}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace kerfbench::twin
