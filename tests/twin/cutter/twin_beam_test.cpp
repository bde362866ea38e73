// SPDX-License-Identifier: Apache-2.0
// Effect of the beam on the board: gates inside a step, slip, oblique spots, chords, noise.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/twin/cutter/machines.h"

namespace kerfbench::twin {
namespace {

constexpr Tick kQuantum = 8000;

// Centre, extent and energy of the burn in a window of the sheet.
struct Burn {
  double energy_j{};
  Eigen::Vector2d centre_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d sigma_mm{Eigen::Vector2d::Zero()};
};

Burn burnOf(const Sheet& sheet, const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm) {
  const Eigen::Vector2i first = (min_mm / Sheet::kCellMm).array().round().cast<int>();
  const Eigen::Vector2i size = ((max_mm - min_mm) / Sheet::kCellMm).array().round().cast<int>();
  std::vector<float> nodes(static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y()));
  sheet.copyNodes(first.x(), first.y(), size.x(), size.y(), nodes);
  Burn burn;
  Eigen::Vector2d squares = Eigen::Vector2d::Zero();
  std::size_t i = 0;
  for (int y = 0; y < size.y(); ++y) {
    for (int x = 0; x < size.x(); ++x, ++i) {
      const Eigen::Vector2d place = Sheet::kCellMm * (first + Eigen::Vector2i(x, y)).cast<double>();
      burn.energy_j += static_cast<double>(nodes[i]);
      burn.centre_mm += static_cast<double>(nodes[i]) * place;
      squares += static_cast<double>(nodes[i]) * place.cwiseProduct(place);
    }
  }
  burn.centre_mm /= burn.energy_j;
  // The spline that the nodes stand for is wider than they are.
  const double spline_mm2 = Sheet::kCellMm * Sheet::kCellMm / 3.0;
  burn.sigma_mm =
      ((squares / burn.energy_j - burn.centre_mm.cwiseProduct(burn.centre_mm)).array() + spline_mm2).sqrt();
  burn.energy_j *= Sheet::kCellMm * Sheet::kCellMm;
  return burn;
}

// A tube that follows its gate at once.
MachineDescription promptLaser() {
  MachineDescription machine = twoMirror();
  machine.laser.rise_time_s = machine.laser.fall_time_s = 0.0;
  return machine;
}

Pins gatePins(const MachineDescription& machine, double on_s, double off_s) {
  Pins pins(machine.signals);
  pins.set(1e-4, Signal::kLaserPwm, true);
  pins.set(on_s, Signal::kLaserGate, true);
  pins.set(off_s, Signal::kLaserGate, false);
  return pins;
}

TEST(TwinBeam, AGateThatMovesInsideAStepBurnsWhereTheBeamWasThen) {
  const auto machine = promptLaser();
  WebDescription web = lineWeb();
  web.belt_speed_mm_s = 4000.0;  // Travel of 40 um in a step.
  // The gate is open for 3 us of a step, at its end, and from the middle of a step to the middle of the one
  // after next.
  for (const auto& [on_us, off_us] :
       {std::pair(1002.0, 1005.0), {1007.0, 1010.0}, {1005.0, 1025.0}, {1009.0, 1011.0}}) {
    const Pins pins = gatePins(machine, on_us * 1e-6, off_us * 1e-6);
    Twin twin(machine, web, kRate);
    run(twin, pins.events(), 0, ticks(2e-3), kQuantum);
    const double mid_s = 0.5e-6 * (on_us + off_us);
    const double place = 157.0 - 4000.0 * mid_s;
    const Burn burn = burnOf(twin.sheet(), {place - 1.0, -1.0}, {place + 1.0, 1.0});
    EXPECT_NEAR(burn.energy_j, 100.0 * (off_us - on_us) * 1e-6, 1e-6 * burn.energy_j + 1e-9);
    EXPECT_NEAR(burn.centre_mm.x(), place, 1e-4) << on_us;
    // The burn is a beam of sigma w/2 drawn out evenly over the travelled distance.
    const double length = 4000.0 * (off_us - on_us) * 1e-6;
    EXPECT_NEAR(burn.sigma_mm.x(), std::hypot(0.5 * 0.105, length / std::sqrt(12.0)), 4e-4) << on_us;
    EXPECT_NEAR(burn.sigma_mm.y(), 0.5 * 0.105, 4e-4) << on_us;
  }
}

TEST(TwinBeam, AGateThatPulsesWithinAStepBurnsEachPulseAtItsPlace) {
  const auto machine = promptLaser();
  WebDescription web = lineWeb();
  web.belt_speed_mm_s = 90000.0;  // Travel of 0.9 mm in a step.
  Pins pins(machine.signals);
  pins.set(1e-4, Signal::kLaserPwm, true);
  // The step that begins at 1 ms has three pulses of 0.5 us.
  for (const double at_us : {1001.0, 1004.0, 1008.0}) {
    pins.set(at_us * 1e-6, Signal::kLaserGate, true);
    pins.set((at_us + 0.5) * 1e-6, Signal::kLaserGate, false);
  }
  Twin twin(machine, web, kRate);
  run(twin, pins.events(), 0, ticks(1.5e-3), kQuantum);
  for (const double at_us : {1001.0, 1004.0, 1008.0}) {
    const double place = 157.0 - 90000.0 * (at_us + 0.25) * 1e-6;
    const Burn burn = burnOf(twin.sheet(), {place - 0.13, -0.5}, {place + 0.13, 0.5});
    EXPECT_NEAR(burn.centre_mm.x(), place, 0.005) << at_us;
    EXPECT_NEAR(burn.energy_j, 100.0 * 0.5e-6, 0.03 * 100.0 * 0.5e-6) << at_us;
  }
}

TEST(TwinBeam, TheBurnIsWhereTheGateWasOpenAndComesLaterByTheDelay) {
  MachineDescription machine = promptLaser();
  const Pins pins = gatePins(machine, 10e-3, 60e-3);
  const auto edges = [&] {
    Twin twin(machine, lineWeb(), kRate, {.fidelity = Fidelity::kFast});
    run(twin, pins.events(), 0, ticks(0.08), kQuantum);
    return burnOf(twin.sheet(), {150.0, -1.0}, {158.0, 1.0});
  };
  const Burn prompt = edges();
  machine.laser.gate_delay_s = 733e-6;
  const Burn late = edges();
  EXPECT_NEAR(prompt.centre_mm.x(), 157.0 - 60.0 * 35e-3, 2e-5);
  EXPECT_NEAR(late.centre_mm.x() - prompt.centre_mm.x(), -60.0 * 733e-6, 2e-5);
  EXPECT_NEAR(prompt.energy_j, 5.0, 1e-5);
  EXPECT_NEAR(late.energy_j, prompt.energy_j, 1e-5);
}

TEST(TwinBeam, ChordsOfAFastAndOfASlowBeamLeaveTheSameLine) {
  // The line has sqrt(2/pi) P / (F w), whatever number of steps made a chord.
  const auto machine = promptLaser();
  for (const double speed : {5.0, 60.0, 700.0, 3000.0}) {
    WebDescription web = lineWeb();
    web.belt_speed_mm_s = speed;
    const double length_s = 10.0 / speed;
    const Pins pins = gatePins(machine, 10e-3, 10e-3 + length_s);
    Twin twin(machine, web, kRate, {.fidelity = Fidelity::kFast});
    run(twin, pins.events(), 0, ticks(20e-3 + length_s), kQuantum);
    const double w = machine.beam.waist_radius_mm;
    const double peak = std::sqrt(2.0 / std::numbers::pi) * 100.0 / (speed * w);
    const double begin = 157.0 - 10e-3 * speed;
    for (double along = 0.5; along < 9.5; along += 0.0371) {
      ASSERT_NEAR(twin.sheet().fluenceAt({begin - along, 0.0}) / peak, 1.0, 1e-3) << speed << " " << along;
      ASSERT_NEAR(twin.sheet().fluenceAt({begin - along, 0.5 * w}) / peak, std::exp(-0.5), 1e-3);
    }
    EXPECT_NEAR(twin.sheet().energyJ(), 100.0 * length_s, 1e-4 * 100.0 * length_s);
  }
}

TEST(TwinBeam, ReadingTheSheetWhileTheBeamIsLitShowsAllOfItAndChangesNoMoreThanRounding) {
  const auto machine = promptLaser();
  const Pins pins = gatePins(machine, 5e-3, 45e-3);
  const auto events = pins.events();
  Twin read_once(machine, lineWeb(), kRate, {.fidelity = Fidelity::kFast});
  run(read_once, events, 0, ticks(0.05), kQuantum);
  Twin read_often(machine, lineWeb(), kRate, {.fidelity = Fidelity::kFast});
  run(read_often, events, 0, ticks(0.05), 1237, [&](Tick, Tick, const auto&) {
    ASSERT_NEAR(read_often.sheet().energyJ(), read_often.truth().emitted_j,
                2e-5 * read_often.truth().emitted_j);
  });
  for (double x = 154.2; x < 156.8; x += 0.013) {
    const double once = read_once.sheet().fluenceAt({x, 0.02});
    ASSERT_NEAR(read_often.sheet().fluenceAt({x, 0.02}), once, 1e-3 * once) << x;
  }
}

TEST(TwinBeam, ASheetThatABrushPullsSidewaysIsCutAskewAndSeenSo) {
  MachineDescription machine = promptLaser();
  // Friction holds 0.6 * 0.05 kg * 9.81 m/s² = 0.294 N; the brush pulls with more.
  machine.belt.sheet_drag_n = {0.0, 0.35};
  Pins pins = gatePins(machine, 10e-3, 90e-3);
  Twin twin(machine, lineWeb(), kRate);
  std::vector<Exposure> exposures;
  run(twin, pins.events(), 0, ticks(0.1), kQuantum, [&](Tick, Tick, const auto&) {
    for (Exposure& e : twin.takeExposures()) exposures.push_back(std::move(e));
  });
  const Eigen::Vector2d slip = twin.pose().sheet_slip_mm;
  ASSERT_GT(slip.y(), 1.0);
  // The spot rests at W's origin: on the sheet it runs towards -y.
  EXPECT_GT(twin.sheet().fluenceAt({157.0 - 60.0 * 10e-3 - 0.1, 0.0}), 0.5);
  const Exposure& last = exposures.back();
  EXPECT_NEAR(last.samples.back().p_WS_mm.y(), slip.y(), 0.2);
  EXPECT_GT(last.samples.back().p_WS_mm.y(), exposures[50].samples[0].p_WS_mm.y());
  // The cut at the time of an exposure is at the place of the web in that exposure.
  for (const std::size_t i : {30U, 60U, 80U}) {
    const ExposureSample& sample = exposures[i].samples[0];
    const Eigen::Vector2d there = sample.p_WQ_mm - sample.p_WS_mm;
    EXPECT_GT(twin.sheet().fluenceAt(there), 3.0 * twin.sheet().fluenceAt(there + Eigen::Vector2d(0, 0.3)));
    EXPECT_GT(twin.sheet().fluenceAt(there), 0.1);
  }
}

TEST(TwinBeam, ASpotFarFromTheAxisIsDrawnOutAndASurfaceThatRisesShiftsIt) {
  MachineDescription machine = promptLaser();
  machine.head.throw_mm = 200.0;
  Pins pins = gatePins(machine, 0.1, 0.1001);
  pins.steps(Signal::kGalvoXPul, 1e-3, 4000, 20e-6, true);  // The turn is 0.05 rad: 21.6 mm.
  WebDescription still = lineWeb();
  still.belt_speed_mm_s = 0.0;
  const auto burnt = [&](double height_mm) {
    machine.surface.height_mm = height_mm;
    Twin twin(machine, still, kRate);
    run(twin, pins.events(), 0, ticks(0.11), kQuantum);
    const double x = twin.truth().p_WQ_mm.x() + 157.0;
    return burnOf(twin.sheet(), {x - 1.0, -1.0}, {x + 1.0, 1.0});
  };
  const Burn flat = burnt(0.0);
  const double tangent = std::tan(0.1);
  EXPECT_NEAR(flat.centre_mm.x() - 157.0, 215.0 * tangent, 1e-3);
  // The oblique spot is longer by 1/cos.
  EXPECT_NEAR(flat.sigma_mm.x() / flat.sigma_mm.y(), 1.0 / std::cos(0.1), 1e-3);
  const Burn raised = burnt(2.0);
  EXPECT_NEAR(raised.centre_mm.x() - flat.centre_mm.x(), -2.0 * tangent, 1e-3);
}

TEST(TwinBeam, ExposuresTellTheSizeOfTheSpotOutOfFocus) {
  MachineDescription machine = promptLaser();
  machine.beam.focus_z_mm = 20.0;  // The focus is one Rayleigh length over the board.
  machine.beam.rayleigh_mm = 20.0;
  Twin twin(machine, lineWeb(), kRate);
  run(twin, {}, 0, ticks(3e-3), kQuantum);
  const auto exposures = twin.takeExposures();
  ASSERT_EQ(exposures.size(), 3U);
  EXPECT_NEAR(exposures[1].samples[2].radius_mm, std::numbers::sqrt2 * 0.105, 1e-6);
}

TEST(TwinBeam, LaserNoiseIsOfItsSeedAndKeepsTheMean) {
  MachineDescription machine = twoMirror();
  machine.laser.noise = 0.05;
  const Pins pins = gatePins(machine, 1e-3, 201e-3);
  const auto emitted = [&](std::uint64_t seed) {
    Twin twin(machine, lineWeb(), kRate, {Fidelity::kFast, seed, false});
    run(twin, pins.events(), 0, ticks(0.21), kQuantum);
    return twin.truth().emitted_j;
  };
  EXPECT_EQ(emitted(1), emitted(1));
  EXPECT_NE(emitted(1), emitted(2));
  // The mean over 200 correlation times of 1 ms wanders by 5 % * sqrt(2 / 200).
  EXPECT_NEAR(emitted(1), 20.0, 4.0 * 20.0 * 0.05 * std::sqrt(2.0 / 200.0));
}

TEST(TwinBeam, ExposuresAreLeftOutOnDemandAndNothingElseChanges) {
  const auto machine = twoMirror();
  const Pins pins = gatePins(machine, 1e-3, 31e-3);
  const auto events = pins.events();
  Twin with(machine, lineWeb(), kRate, {.fidelity = Fidelity::kFast});
  Twin without(machine, lineWeb(), kRate, {.fidelity = Fidelity::kFast, .record_exposures = false});
  run(with, events, 0, ticks(0.04), kQuantum);
  run(without, events, 0, ticks(0.04), kQuantum);
  EXPECT_EQ(with.takeExposures().size(), 40U);
  EXPECT_TRUE(without.takeExposures().empty());
  std::vector<float> a(200 * 200);
  std::vector<float> b(200 * 200);
  with.sheet().copyNodes(7700, -100, 200, 200, a);
  without.sheet().copyNodes(7700, -100, 200, 200, b);
  EXPECT_GT(*std::ranges::max_element(a), 0.1F);
  EXPECT_TRUE(a == b);
}

}  // namespace
}  // namespace kerfbench::twin
