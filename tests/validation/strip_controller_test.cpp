// SPDX-License-Identifier: Apache-2.0
// Test of the motion generator by itself: its pulses are those of its tracks.
#include <cmath>
#include <cstdlib>
#include <map>

#include <gtest/gtest.h>

#include "tests/validation/strip_controller.h"
#include "tests/validation/strip_track.h"

namespace kerfbench::validation {
namespace {

constexpr TickRate kRate{1, 16'000'000};
constexpr double kStep_mm = 0.0125;

TEST(Track, AMoveEndsAtRestInItsPlace) {
  for (const double start_mm_s : {0.0, 200.0, -150.0}) {
    for (const double to_mm : {700.0, -3.0, 0.02, 0.0}) {
      Track track(5.0);
      if (start_mm_s != 0.0) track.speedUpTo(start_mm_s, 2500.0);
      track.moveTo(to_mm, 400.0, 2500.0);
      EXPECT_NEAR(track.place_mm(), to_mm, 1e-12);
      const double rest_s = track.time_s();
      double place_mm = 5.0;
      double speed_mm_s = 0.0;
      double end_s = 0.0;
      while (const Track::Piece* piece = track.front()) {
        EXPECT_NEAR(piece->place_mm, place_mm, 1e-9);
        EXPECT_NEAR(piece->speed_mm_s, speed_mm_s, 1e-9);
        EXPECT_EQ(piece->begin_s, end_s);
        const double t = piece->end_s - piece->begin_s;
        place_mm += piece->direction() * piece->distance_mm(piece->end_s);
        speed_mm_s += piece->acceleration_mm_s2 * t;
        EXPECT_LE(std::abs(speed_mm_s), 400.0 + 1e-9);
        end_s = piece->end_s;
        track.dropFront();
      }
      EXPECT_EQ(end_s, rest_s);
      EXPECT_NEAR(place_mm, to_mm, 1e-9);
      EXPECT_NEAR(speed_mm_s, 0.0, 1e-9);
    }
  }
}

TEST(PulseTrain, StaysWithinHalfAStepOfItsTrack) {
  PulseTrain train(Signal::kGantryXPul, Signal::kGantryXDir, kStep_mm, 0.0);
  Track copy(0.0);
  for (Track* track : {&train.track(), &copy}) {
    track->speedUpTo(200.0, 2500.0);
    track->keepUntil(0.3);
    track->moveTo(-7.0, 400.0, 2500.0);
    track->moveTo(0.0, 50.0, 20000.0);
  }
  std::vector<PinWrite> writes;
  for (double t = 0.0; t < copy.time_s() + 1e-3; t += 0.37e-3) train.appendUntil(t, kRate, writes);
  long long count = 0;
  bool dir = false;
  Tick dir_tick = 0;
  for (const PinWrite& write : writes) {
    if (write.signal == Signal::kGantryXDir) {
      dir = write.level;
      dir_tick = write.tick;
    } else if (write.level) {
      EXPECT_GT(kRate.seconds(write.tick - dir_tick), 100e-6);  // A DM556 needs 5 us.
      const double time_s = kRate.seconds(write.tick) + 0.5 * kRate.seconds(1);
      while (copy.front() != nullptr && copy.front()->end_s < time_s - kRate.seconds(1)) copy.dropFront();
      ASSERT_NE(copy.front(), nullptr);
      const Track::Piece& piece = *copy.front();
      const double place_mm = piece.place_mm + piece.direction() * piece.distance_mm(time_s);
      const double middle = (static_cast<double>(count) + (dir ? 0.5 : -0.5)) * kStep_mm;
      EXPECT_NEAR(place_mm, middle, 1e-4) << "at " << time_s << " s";
      count += dir ? 1 : -1;
    }
  }
  EXPECT_EQ(count, 0);
  EXPECT_GT(writes.size(), 10000U);
}

TEST(StripJob, ThePapersExample) {
  StripJob job;
  EXPECT_NEAR(job.returnLimit_mm_s(), 275.9, 0.05);
  EXPECT_NEAR(job.formula_s(100), 603.5, 0.03);
  job.regime = StripJob::Regime::kStopAndGo;
  EXPECT_NEAR(job.formula_s(100), 950.0, 2.2);  // The paper rounds 9.478 to 9.5.
}

TEST(StripJob, WithoutRampsTheCycleIsThePapers) {
  StripJob job;
  job.gantry_acceleration_mm_s2 = 1e9;
  job.run_up_mm = 1e-6;
  EXPECT_NEAR(job.cycle_s(), job.idealCycle_s(), 1e-5);
}

/// All pin events of a time, with any quanta.
std::vector<PinEvent> eventsOf(const StripJob& job, Tick quantum, double length_s) {
  twin::MachineDescription machine;
  machine.gantry_x.step = machine.gantry_y.step = machine.belt.feed.step = kStep_mm;
  std::uint16_t bit = 0;
  for (const Signal signal :
       {Signal::kGantryXPul, Signal::kGantryXDir, Signal::kGantryYPul, Signal::kGantryYDir, Signal::kFeedPul,
        Signal::kFeedDir, Signal::kLaserGate, Signal::kLaserPwm}) {
    machine.signals.assign(signal, {0, bit++});
  }
  StripController controller(job, machine, kRate);
  std::vector<PinEvent> events;
  for (Tick now = 0; now < kRate.ticksAt(length_s);) controller.advance(now += quantum, events);
  return events;
}

TEST(StripController, QuantaLeaveNoTrace) {
  for (const auto regime : {StripJob::Regime::kContinuous, StripJob::Regime::kStopAndGo}) {
    StripJob job;
    job.regime = regime;
    job.length_mm = 100.0;
    job.width_mm = 40.0;
    const auto fine = eventsOf(job, 1600, 4.0);
    const auto coarse = eventsOf(job, 16000, 4.0);
    ASSERT_EQ(fine.size(), coarse.size());
    for (std::size_t i = 0; i < fine.size(); ++i) {
      ASSERT_EQ(fine[i].tick, coarse[i].tick);
      ASSERT_EQ(fine[i].level, coarse[i].level);
      if (i > 0) {
        ASSERT_GE(fine[i].tick, fine[i - 1].tick);
      }
    }
    EXPECT_GT(fine.size(), 10000U);
  }
}

}  // namespace
}  // namespace kerfbench::validation
