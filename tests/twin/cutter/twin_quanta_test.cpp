// SPDX-License-Identifier: Apache-2.0
// The twin's state depends on description, seed and pin events alone, bit by bit.
#include <algorithm>
#include <cmath>

#include <bit>
#include <cstdint>
#include <span>

#include <gtest/gtest.h>

#include "tests/twin/cutter/machines.h"
#include "twin/base/random.h"
#include "twin/description/imperfections.h"

namespace kerfbench::twin {
namespace {

constexpr double kEndS = 0.06;

// Pins of a controller that jogs all axes at random, breaks every timing rule now and then, and fires the
// laser.
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

// Hash FNV-1a over the bytes of numbers.
class Digest {
 public:
  void add(std::uint64_t bits) {
    for (int i = 0; i < 8; ++i) value_ = (value_ ^ (bits >> (8 * i) & 0xffU)) * 0x100000001b3ULL;
  }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_{0xcbf29ce484222325ULL};
};

struct Outcome {
  std::uint64_t sensors{};  ///< Digest of all edges; without meaning unless sensors are predicted.
  Twin::Truth truth;
  std::vector<float> nodes;
  std::vector<Exposure> exposures;
};

Outcome outcome(const MachineDescription& machine, const WebDescription& web,
                const std::vector<PinEvent>& events, Tick quantum, bool predict, const TwinOptions& options) {
  Twin twin(machine, web, kRate, options);
  Outcome result;
  Digest sensors;
  const auto collect = [&](Tick, Tick, const std::vector<SensorEdge>& edges) {
    for (const SensorEdge& e : edges) {
      sensors.add(e.tick);
      sensors.add(static_cast<std::uint64_t>(e.signal) << 1U | (e.level ? 1U : 0U));
    }
    for (Exposure& e : twin.takeExposures()) result.exposures.push_back(std::move(e));
  };
  run(twin, events, 0, ticks(kEndS), quantum, predict ? QuantumFn(collect) : QuantumFn());
  collect(0, 0, {});
  result.sensors = sensors.value();
  result.truth = twin.truth();
  constexpr int kColumns = 1200;
  constexpr int kRows = 1200;
  result.nodes.resize(static_cast<std::size_t>(kColumns) * kRows);
  twin.sheet().copyNodes(static_cast<int>(148.0 / Sheet::kCellMm), -kRows / 2, kColumns, kRows, result.nodes);
  return result;
}

void expectSame(const Outcome& a, const Outcome& b) {
  EXPECT_EQ(a.truth.time_s, b.truth.time_s);
  EXPECT_EQ(a.truth.belt_travel_mm, b.truth.belt_travel_mm);
  EXPECT_EQ(a.truth.emitted_j, b.truth.emitted_j);
  EXPECT_EQ(a.truth.p_WQ_mm, b.truth.p_WQ_mm);
  EXPECT_TRUE(a.nodes == b.nodes);
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
}

struct Setup {
  const char* name;
  MachineDescription (*machine)();
  WebDescription (*web)();
  Fidelity fidelity;
  Preset preset;
};

class TwinQuanta : public testing::TestWithParam<Setup> {
 protected:
  [[nodiscard]] MachineDescription drawn(std::uint64_t seed) const {
    MachineDescription machine = drawImperfections(GetParam().machine(), {}, GetParam().preset, seed).machine;
    machine.signals.assign(Signal::kPowerMonitor, {4, 0});
    return machine;
  }
  const WebDescription web = GetParam().web();
  const std::vector<PinEvent> events = jog(GetParam().machine());
};

TEST_P(TwinQuanta, TheEndIsTheSameBitByBitForAnyQuantaWithAndWithoutPrediction) {
  const auto machine = drawn(1);
  const TwinOptions options{.fidelity = GetParam().fidelity, .seed = 1};
  const Outcome reference = outcome(machine, web, events, ticks(500e-6), false, options);
  EXPECT_GT(reference.truth.emitted_j, 1.0);
  EXPECT_GT(*std::ranges::max_element(reference.nodes), 0.1F);
  EXPECT_EQ(reference.exposures.size(), 60U);
  for (const auto& [quantum, predict] : {std::pair(ticks(100e-6), true),
                                         {ticks(500e-6), true},
                                         {ticks(1e-3), false},
                                         {Tick{1237}, true},
                                         {ticks(kEndS), false},
                                         {ticks(kEndS), true}}) {
    SCOPED_TRACE(testing::Message() << quantum << " ticks, prediction " << predict);
    expectSame(outcome(machine, web, events, quantum, predict, options), reference);
  }
}

TEST_P(TwinQuanta, TheSameSeedGivesTheSameBytesAndSensorsEachTimeAndAnotherSeedDoesNot) {
  const auto run = [&](std::uint64_t seed) {
    return outcome(drawn(seed), web, events, ticks(500e-6), true,
                   {.fidelity = GetParam().fidelity, .seed = seed});
  };
  const Outcome first = run(5);
  for (int i = 0; i < 2; ++i) {
    const Outcome again = run(5);
    expectSame(again, first);
    EXPECT_EQ(again.sensors, first.sensors);
  }
  const Outcome other = run(6);
  const bool ideal = GetParam().preset == Preset::kIdeal;
  // Nothing is sampled for an ideal machine, and nothing of it is noise.
  EXPECT_EQ(other.sensors == first.sensors, ideal);
  EXPECT_EQ(other.truth.emitted_j == first.truth.emitted_j, ideal);
  EXPECT_EQ(other.nodes == first.nodes, ideal);
}

INSTANTIATE_TEST_SUITE_P(
    Machines, TwinQuanta,
    testing::Values(Setup{"MirrorsOnLine", twoMirror, lineWeb, Fidelity::kReference, Preset::kIdeal},
                    Setup{"MirrorsOnLineDrawn", twoMirror, lineWeb, Fidelity::kReference, Preset::kDynamic},
                    Setup{"MirrorsOnLineFast", twoMirror, lineWeb, Fidelity::kFast, Preset::kDynamic},
                    Setup{"MirrorsFedFast", twoMirror, fedWeb, Fidelity::kFast, Preset::kIdeal},
                    Setup{"GantryOnLine", gantry, lineWeb, Fidelity::kReference, Preset::kIdeal},
                    Setup{"GantryOnLineFast", gantry, lineWeb, Fidelity::kFast, Preset::kDynamic}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace kerfbench::twin
