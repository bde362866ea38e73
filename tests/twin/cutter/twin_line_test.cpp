// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/twin/cutter/machines.h"

namespace kerfbench::twin {
namespace {

constexpr Tick kQuantum = 8000;

WebDescription rampedWeb() {
  WebDescription web = lineWeb();
  web.belt_speed_changes = {{0.2, 60.0}, {0.5, 90.0}, {1.0, 40.0}};
  return web;
}

TEST(TwinLine, TheBeltFollowsALineThatChangesItsSpeed) {
  const auto machine = twoMirror();
  const WebDescription web = rampedWeb();
  const SpeedProfile line(web.belt_speed_mm_s, web.belt_speed_changes);
  Twin twin(machine, web, kRate, {.fidelity = Fidelity::kFast});
  // The drive has velocity feedforward through a filter: on a ramp the roller lags by acceleration * (1 / wn²
  // + 2 zeta / wn * filter), and not at all at constant speed. The belt trails the roller by the stretch from
  // its mass and the board's.
  const ServoDescription& servo = machine.belt.line_servo;
  const double wn = servo.natural_frequency_rad_s;
  const double lag_s2 = 1.0 / (wn * wn) + 2.0 * servo.damping / wn * servo.feedforward_filter_s +
                        (machine.belt.mass_kg + machine.belt.sheet_mass_kg) / machine.belt.stiffness_n_m;
  for (const double at_s : {0.19, 0.4, 0.9, 1.4}) {
    twin.advance(ticks(at_s), {});
    const double acceleration = (line.speed_mm_s(at_s) - line.speed_mm_s(at_s - 1e-3)) / 1e-3;
    EXPECT_NEAR(twin.truth().belt_travel_mm, line.travel_mm(at_s) - acceleration * lag_s2, 1e-6) << at_s;
  }
}

TEST(TwinLine, TheEncoderTellsThatTravelWithinACount) {
  const auto machine = twoMirror();
  Twin twin(machine, rampedWeb(), kRate, {.fidelity = Fidelity::kFast});
  QuadratureCounter counter;
  run(twin, {}, 0, ticks(1.5), kQuantum, [&](Tick, Tick, const std::vector<SensorEdge>& edges) {
    for (const SensorEdge& edge : edges) {
      if (edge.signal == Signal::kEncoderA || edge.signal == Signal::kEncoderB) counter.apply(edge);
    }
    // Edges go up to the end of the quantum, which the twin reaches right after.
    const double counted_mm = static_cast<double>(counter.count()) * machine.belt.encoder.count_mm;
    ASSERT_NEAR(counted_mm, twin.pose().roller_mm, 1.1 * machine.belt.encoder.count_mm);
  });
  EXPECT_EQ(counter.illegal(), 0);
}

TEST(TwinLine, AGateDelayMovesTheBurnAndKeepsItsEnergy) {
  MachineDescription machine = twoMirror();
  Pins pins(machine.signals);
  pins.set(1e-3, Signal::kLaserPwm, true);
  pins.set(10e-3, Signal::kLaserGate, true);
  pins.set(20e-3, Signal::kLaserGate, false);
  const auto emittedBy = [&](double at_s) {
    Twin twin(machine, lineWeb(), kRate);
    run(twin, pins.events(), 0, ticks(at_s), kQuantum);
    return twin.truth().emitted_j;
  };
  const double early_j = emittedBy(15e-3);
  const double all_j = emittedBy(40e-3);
  machine.laser.gate_delay_s = 137e-6;
  EXPECT_NEAR(early_j - emittedBy(15e-3), machine.laser.full_power_w * 137e-6, 1e-6);
  EXPECT_NEAR(emittedBy(40e-3), all_j, 1e-6 * all_j);
}

}  // namespace
}  // namespace kerfbench::twin
