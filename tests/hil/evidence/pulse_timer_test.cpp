// SPDX-License-Identifier: Apache-2.0
#include "hil/evidence/pulse_timer.h"

#include <cmath>
#include <cstdint>
#include <numeric>

#include <gtest/gtest.h>

#include "twin/base/pin_event.h"

namespace kerfbench::evidence {
namespace {

constexpr double kUs = 1e-6;

DriverProfile dm556() { return {"DM556", true, 5 * kUs, 10 * kUs, 2.5 * kUs, 2.5 * kUs}; }
DriverProfile gecko201() { return {"Gecko201", false, 1 * kUs, 20 * kUs, 0.5 * kUs, 4 * kUs}; }

// The two wires, in microseconds.
class Wires {
 public:
  explicit Wires(const DriverProfile& profile, bool has_enable = false)
      : timer_("axis", profile, has_enable) {}
  Wires& enable(double at_us, bool level) {
    timer_.enableLevel(at_us * kUs, level);
    return *this;
  }
  Wires& pul(double at_us, bool level) { return set(at_us, level, dir_); }
  Wires& dir(double at_us, bool level) { return set(at_us, pul_, level); }
  Wires& set(double at_us, bool pul_level, bool dir_level) {
    pul_ = pul_level;
    dir_ = dir_level;
    timer_.levels(at_us * kUs, pul_, dir_);
    return *this;
  }
  Wires& pulse(double at_us, double width_us) { return pul(at_us, true).pul(at_us + width_us, false); }
  [[nodiscard]] const PulseTiming& timing() const { return timer_.timing(); }
  [[nodiscard]] std::uint64_t violations() const {
    const PulseTiming& t = timing();
    return t.setup_violations + t.hold_violations + t.width_violations + t.space_violations;
  }

 private:
  PulseTimer timer_;
  bool pul_{false}, dir_{false};
};

TEST(PulseTimer, CountsPulsesAndFindsNothingWrongWithGoodOnes) {
  Wires wires(dm556());
  wires.pulse(100, 5).dir(120, true).pulse(140, 5).pulse(160, 5).dir(180, false).pulse(200, 5);
  EXPECT_EQ(wires.timing().pulses, 4U);
  EXPECT_EQ(wires.violations(), 0U);
  EXPECT_LT(wires.timing().first_violation_s, 0.0);
}

TEST(PulseTimer, CountsPulsesWhileTheDriveIsDisabled) {
  Wires wires(dm556(), true);
  wires.pulse(100, 5).pulse(120, 5).enable(140, true).pulse(160, 5).enable(180, false).pulse(200, 5);
  EXPECT_EQ(wires.timing().pulses, 4U);
  EXPECT_EQ(wires.timing().disabled_pulses, 3U);
  EXPECT_NEAR(wires.timing().first_violation_s, 100 * kUs, 1e-12);
  EXPECT_TRUE(wires.timing().has_enable);
  EXPECT_EQ(wires.violations(), 0U) << "times are as they should be";
}

TEST(PulseTimer, ADriveThatIsEnabledWhileLowIsSoFromTheStart) {
  DriverProfile profile = dm556();
  profile.enable_low = true;
  Wires wires(profile, true);
  wires.pulse(100, 5).enable(120, true).pulse(140, 5).enable(160, false).pulse(180, 5);
  EXPECT_EQ(wires.timing().disabled_pulses, 1U);
  EXPECT_NEAR(wires.timing().first_violation_s, 140 * kUs, 1e-12);
}

TEST(PulseTimer, WithoutAnEnableLineADriveIsAlwaysEnabled) {
  Wires wires(dm556());
  wires.pulse(100, 5);
  EXPECT_EQ(wires.timing().disabled_pulses, 0U);
  EXPECT_FALSE(wires.timing().has_enable);
  EXPECT_TRUE(std::isinf(wires.timing().min_enable_setup_s));
}

TEST(PulseTimer, TheFirstChangeAfterAnEnableKeepsItsSetUpTime) {
  DriverProfile profile = dm556();
  profile.enable_setup_s = 50 * kUs;
  Wires good(profile, true);
  good.enable(100, true).dir(150, true).pulse(160, 5).enable(300, false).dir(400, false).enable(410, true);
  good.pulse(470, 5);
  EXPECT_EQ(good.timing().enable_setup_violations, 0U);
  EXPECT_NEAR(good.timing().min_enable_setup_s, 50 * kUs, 1e-12);
  Wires early_dir(profile, true);
  early_dir.enable(100, true).dir(149, true).pulse(160, 5);
  EXPECT_EQ(early_dir.timing().enable_setup_violations, 1U);
  EXPECT_NEAR(early_dir.timing().first_violation_s, 149 * kUs, 1e-12);
  Wires early_pul(profile, true);
  early_pul.enable(100, true).pulse(130, 5).pulse(140, 5);
  EXPECT_EQ(early_pul.timing().enable_setup_violations, 1U);
  EXPECT_NEAR(early_pul.timing().min_enable_setup_s, 30 * kUs, 1e-12);
}

TEST(PulseTimer, ReportsTheShortestTimesSeen) {
  Wires wires(dm556());
  wires.pulse(100, 5).dir(120, true).pulse(129, 3).pulse(140, 7).dir(155, false).pulse(200, 5);
  EXPECT_NEAR(wires.timing().min_setup_s, 9 * kUs, 1e-12);
  EXPECT_NEAR(wires.timing().min_hold_s, 15 * kUs, 1e-12);
  EXPECT_NEAR(wires.timing().min_width_s, 3 * kUs, 1e-12);
  EXPECT_NEAR(wires.timing().min_space_s, 8 * kUs, 1e-12);
}

TEST(PulseTimer, WithoutPulsesNoTimeWasSeen) {
  Wires wires(dm556());
  wires.dir(1, true).dir(2, false);
  EXPECT_TRUE(std::isinf(wires.timing().min_setup_s));
  EXPECT_TRUE(std::isinf(wires.timing().min_hold_s));
  EXPECT_TRUE(std::isinf(wires.timing().min_width_s));
  EXPECT_TRUE(std::isinf(wires.timing().min_space_s));
  EXPECT_EQ(wires.violations(), 0U);
}

TEST(PulseTimer, ADirThatIsTooLateIsCountedWithItsTime) {
  Wires wires(dm556());
  wires.dir(100, true).pulse(104.9, 5).pulse(120, 5);
  EXPECT_EQ(wires.timing().setup_violations, 1U);
  EXPECT_EQ(wires.violations(), 1U);
  EXPECT_NEAR(wires.timing().first_violation_s, 104.9 * kUs, 1e-12);
}

TEST(PulseTimer, ATimeThatIsExactlyTheLimitIsNoViolation) {
  Wires wires(dm556());
  wires.dir(100, true).pulse(105, 2.5).pulse(110, 2.5).dir(120, false).pulse(125, 2.5);
  EXPECT_EQ(wires.violations(), 0U);
}

TEST(PulseTimer, ATimeThatIsExactlyTheLimitIsNoViolationAfterADayEither) {
  // The times are whole numbers of ticks of 62.5 ns: width 2.5 us, space 2.5 us, set-up 5 us and hold 10 us.
  PulseTimer timer("axis", dm556());
  const TickRate rate{1, 16'000'000};
  Tick tick = 86'400ULL * 16'000'000ULL + 7;
  const auto set = [&](Tick after, bool pul, bool dir) {
    tick += after;
    timer.levels(rate.seconds(tick), pul, dir);
  };
  bool dir = false;
  for (int i = 0; i < 5000; ++i) {
    set(120, false, dir = !dir);  // The hold is 40 + 120 ticks.
    set(80, true, dir);
    set(40, false, dir);
    set(40, true, dir);
    set(40, false, dir);
    tick += static_cast<Tick>(i % 13);
  }
  const PulseTiming& t = timer.timing();
  EXPECT_EQ(t.setup_violations + t.hold_violations + t.width_violations + t.space_violations, 0U);
}

TEST(PulseTimer, AGlitchOfDirWithinTheSetupTimeIsCounted) {
  Wires wires(dm556());
  wires.dir(10, true).dir(100, false).dir(101, true).pulse(102, 5);
  EXPECT_EQ(wires.timing().setup_violations, 1U);
}

TEST(PulseTimer, ADirThatChangesTooSoonAfterTheEdgeIsAHoldViolation) {
  Wires wires(dm556());
  wires.dir(50, true).pulse(100, 5).dir(109.9, false);
  EXPECT_EQ(wires.timing().hold_violations, 1U);
  EXPECT_EQ(wires.violations(), 1U);
  EXPECT_NEAR(wires.timing().first_violation_s, 109.9 * kUs, 1e-12);
}

TEST(PulseTimer, APulseThatIsTooShortIsCounted) {
  Wires wires(dm556());
  wires.pulse(100, 2.4).pulse(120, 2.6);
  EXPECT_EQ(wires.timing().width_violations, 1U);
  EXPECT_EQ(wires.timing().pulses, 2U);
  EXPECT_EQ(wires.violations(), 1U);
}

TEST(PulseTimer, APauseThatIsTooShortIsCounted) {
  Wires wires(dm556());
  wires.pulse(100, 5).pulse(107.4, 5).pulse(120, 5);
  EXPECT_EQ(wires.timing().space_violations, 1U);
  EXPECT_EQ(wires.violations(), 1U);
}

TEST(PulseTimer, DirAndPulInOneWriteHaveNoSetupAtAll) {
  Wires wires(dm556());
  wires.set(100, true, true).set(105, false, true).pulse(120, 5);
  EXPECT_EQ(wires.timing().setup_violations, 1U);
  EXPECT_EQ(wires.timing().min_setup_s, 0.0);
}

TEST(PulseTimer, TheActiveEdgeCanBeTheFallingOne) {
  Wires wires(gecko201());
  wires.pul(10, true).dir(20, true).pul(30, false);
  wires.pul(40, true).pul(50, false).pul(60, true).dir(75, false).pul(90, false);
  EXPECT_EQ(wires.timing().pulses, 3U);
  EXPECT_EQ(wires.violations(), 0U);
  EXPECT_NEAR(wires.timing().min_width_s, 10 * kUs, 1e-12);
  EXPECT_NEAR(wires.timing().min_hold_s, 25 * kUs, 1e-12);
}

TEST(PulseTimer, APinThatRestsLowFromTheStartIsNoPulseOfAFallingEdgeDrive) {
  Wires wires(gecko201());
  wires.pul(10, false).dir(20, true).dir(30, false);
  EXPECT_EQ(wires.timing().pulses, 0U);
}

TEST(PulseTimer, TheHistogramCountsTheSetupTimeOfEveryActiveEdge) {
  Wires wires(dm556());
  wires.pulse(10, 5);  // DIR never changed: the open last bin.
  wires.dir(100, true)
      .pulse(107.2, 5)  // Bin 14.
      .dir(200, false)
      .pulse(200.2, 5)  // Bin 0.
      .dir(300, true)
      .pulse(329.9, 5)  // Bin 59.
      .dir(400, false)
      .pulse(430.1, 5)  // The open last bin.
      .pulse(500, 5);
  const auto& bins = wires.timing().setup_histogram;
  ASSERT_EQ(bins.size(), 61U);
  EXPECT_EQ(bins[14], 1U);
  EXPECT_EQ(bins[0], 1U);
  EXPECT_EQ(bins[59], 1U);
  EXPECT_EQ(bins[60], 3U);
  EXPECT_EQ(std::accumulate(bins.begin(), bins.end(), std::uint64_t{0}), wires.timing().pulses);
}

}  // namespace
}  // namespace kerfbench::evidence
