// SPDX-License-Identifier: Apache-2.0
// The firmware's loop on the measured power, with a tube and a meter of the test's own.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "firmware_under_test/planner/power/loop.h"

extern "C" {
#include "firmware_under_test/controller/core/power_loop.h"
}

namespace kerfbench::controller_test {
namespace {

constexpr int kPeriodTicks = KB_TICKS_PER_PERIOD;

/// Number of edges in a period of a tube at full gate: bent, as tubes are.
double edgesOf(double byte) { return 130.0 * std::pow(byte / 255.0, 0.8); }

std::vector<std::uint8_t> payloadOf(int gain, int least, int most, int delay_ticks) {
  std::vector<std::uint8_t> payload{
      static_cast<std::uint8_t>(gain), static_cast<std::uint8_t>(least), static_cast<std::uint8_t>(most),
      static_cast<std::uint8_t>(delay_ticks & 0xFF), static_cast<std::uint8_t>(delay_ticks >> 8)};
  for (int i = 0; i < KB_POWER_POINTS; ++i) {
    const auto sixteenths = static_cast<unsigned>(std::lround(16.0 * edgesOf(std::min(16 * i, 255))));
    payload.push_back(static_cast<std::uint8_t>(sixteenths & 0xFFU));
    payload.push_back(static_cast<std::uint8_t>(sixteenths >> 8));
  }
  return payload;
}

bool configure(const std::vector<std::uint8_t>& payload) {
  kb_power_init();
  return kb_power_configure(payload.data(), static_cast<std::uint8_t>(payload.size()));
}

/// A tube with `gain` times its nominal power, behind a meter that is `delay_ticks` late.
class Tube {
 public:
  explicit Tube(double gain, int delay_ticks) : gain_(gain), delay_ticks_(delay_ticks) {}

  /// Runs one period, while the next is prepared. Returns the byte for the next.
  std::uint8_t period(bool lit, std::uint8_t power) {
    kb_power_boundary(static_cast<std::uint8_t>(static_cast<std::uint64_t>(seen_) & 0xFFU));
    // The period offered last runs now.
    for (int t = 0; t < kPeriodTicks; ++t)
      emitted_.push_back(running_lit_ ? gain_ * edgesOf(running_) / kPeriodTicks : 0.0);
    const std::uint8_t byte = kb_power_command(lit, power);
    last_share_ = running_lit_ ? gain_ * edgesOf(running_) / edgesOf(asked_) : 1.0;
    running_ = byte;
    running_lit_ = lit;
    asked_ = power;
    while (counted_ + static_cast<std::size_t>(delay_ticks_) < emitted_.size())
      seen_ += dead_ ? (++counted_, 0.0) : emitted_[counted_++];
    return byte;
  }
  /// Power of the present period over the power in the program.
  [[nodiscard]] double share() const { return last_share_; }
  void die() { dead_ = true; }

 private:
  double gain_;
  int delay_ticks_;
  bool dead_{false};
  bool running_lit_{false};
  double running_{};
  double asked_{};
  double last_share_{1.0};
  double seen_{};
  std::size_t counted_{};
  std::vector<double> emitted_;
};

constexpr int kGain = 36;
constexpr int kDelay = 48;

TEST(PowerLoop, BringsAWeakOrStrongTubeToWhatIsAskedWithoutRinging) {
  for (const double gain : {0.7, 0.95, 1.2, 1.5}) {
    ASSERT_TRUE(configure(payloadOf(kGain, 10, 255, kDelay)));
    Tube tube(gain, kDelay);
    double worst_late = 0.0;
    double beyond = 0.0;
    for (int k = 0; k < 400; ++k) {
      tube.period(true, 120);
      const double error = tube.share() - 1.0;
      if (k > 60) worst_late = std::max(worst_late, std::abs(error));
      beyond = std::max(beyond, gain < 1.0 ? error : -error);
    }
    EXPECT_LT(worst_late, 0.012) << "one edge of 71, and half a step of the byte";
    EXPECT_LT(beyond, 0.25 * std::abs(gain - 1.0) + 0.012) << gain;
  }
}

TEST(PowerLoop, SettlesWhereItsSpecificationDoes) {
  const planner::PowerLimits limits{0.0, 1000.0};
  for (const double gain : {0.8, 1.2}) {
    ASSERT_TRUE(configure(payloadOf(kGain, 10, 255, kDelay)));
    Tube tube(gain, kDelay);
    double spec_w = 100.0;
    std::uint8_t byte = 0;
    for (int k = 0; k < 400; ++k) {
      byte = tube.period(true, 120);
      spec_w = planner::nextPower(spec_w, 100.0, gain * spec_w, limits, 0.4);
    }
    EXPECT_NEAR(edgesOf(byte) / edgesOf(120), spec_w / 100.0, 0.012);
  }
}

TEST(PowerLoop, WhatItHasLearntHoldsOnRamps) {
  ASSERT_TRUE(configure(payloadOf(kGain, 10, 255, kDelay)));
  Tube tube(0.85, kDelay);
  double worst = 0.0;
  for (int k = 0; k < 1000; ++k) {
    const int phase = k % 50;  // 20 ms up, as long down, from a fifth of the power
    const auto power = static_cast<std::uint8_t>(30 + 6 * std::min(phase, 50 - phase));
    tube.period(true, power);
    if (k > 200) worst = std::max(worst, std::abs(tube.share() - 1.0));
  }
  EXPECT_LT(worst, 0.03) << "half a step of the byte at 30 is 1.3 %";
}

TEST(PowerLoop, LearnsNothingInTheDarkNorFromAMeterThatIsDead) {
  ASSERT_TRUE(configure(payloadOf(kGain, 10, 255, kDelay)));
  Tube tube(0.8, kDelay);
  for (int k = 0; k < 200; ++k) tube.period(true, 120);
  const std::uint16_t learnt = kb_power_trim();
  EXPECT_GT(learnt, 16384 * 1.2);
  for (int k = 0; k < 200; ++k) EXPECT_EQ(tube.period(false, 0), 0);
  EXPECT_NEAR(kb_power_trim(), learnt, 200);
  tube.die();
  std::uint8_t byte = 0;
  for (int k = 0; k < 30; ++k) byte = tube.period(true, 120);
  EXPECT_EQ(kb_power_trim(), 16384) << "open again";
  EXPECT_NEAR(byte, 120, 1);
}

TEST(PowerLoop, KeepsTheLasersLimits) {
  ASSERT_TRUE(configure(payloadOf(kGain, 40, 200, kDelay)));
  Tube weak(0.6, kDelay);
  for (int k = 0; k < 300; ++k) EXPECT_LE(weak.period(true, 190), 200);
  EXPECT_EQ(weak.period(true, 12), 40) << "the least that it burns with";
  EXPECT_EQ(weak.period(false, 7), 7) << "dark: the idle power is not the loop's";
}

TEST(PowerLoop, WithoutItThePowerIsTheProgramsOwn) {
  kb_power_init();
  Tube tube(0.5, kDelay);
  for (int power = 0; power < 256; ++power)
    EXPECT_EQ(tube.period(true, static_cast<std::uint8_t>(power)), power);
}

TEST(PowerLoop, AnUntrimmedPowerComesBackAsItself) {
  ASSERT_TRUE(configure(payloadOf(1, 0, 255, kDelay)));
  for (int power = 1; power < 256; ++power)
    EXPECT_NEAR(kb_power_command(true, static_cast<std::uint8_t>(power)), power, 1);
}

TEST(PowerLoop, RefusesWhatMakesNoSense) {
  EXPECT_FALSE(configure(payloadOf(0, 10, 255, kDelay)));
  EXPECT_FALSE(configure(payloadOf(kGain, 200, 100, kDelay)));
  EXPECT_FALSE(configure(payloadOf(kGain, 10, 255, KB_POWER_DELAY_MAX + 1)));
  auto falling = payloadOf(kGain, 10, 255, kDelay);
  falling[20] = falling[21] = 0;
  EXPECT_FALSE(configure(falling));
  EXPECT_TRUE(configure({}));
}

TEST(PowerLoop, EveryByteStreamLeavesThePowerWithinTheLimits) {
  std::uint32_t state = 1;
  const auto random = [&] { return (state = state * 1664525U + 1013904223U) >> 16; };
  ASSERT_TRUE(configure(payloadOf(255, 40, 200, kDelay)));
  for (int k = 0; k < 20000; ++k) {
    kb_power_boundary(static_cast<std::uint8_t>(random()));
    const bool lit = random() % 8 != 0;
    const std::uint8_t byte = kb_power_command(lit, static_cast<std::uint8_t>(random()));
    if (lit) {
      EXPECT_GE(byte, 40);
      EXPECT_LE(byte, 200);
    }
    EXPECT_GE(kb_power_trim(), 8192);
    EXPECT_LE(kb_power_trim(), 32767);
  }
}

}  // namespace
}  // namespace kerfbench::controller_test
