// SPDX-License-Identifier: Apache-2.0
#include "twin/signal/pulse_decoder.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "twin/base/pin_event.h"
#include "twin/base/random.h"

namespace kerfbench::twin {
namespace {

constexpr double kUs = 1e-6;

DriverProfile dm556() { return {"DM556", true, 5 * kUs, 10 * kUs, 2.5 * kUs, 2.5 * kUs}; }
DriverProfile gecko201() { return {"Gecko201", false, 1 * kUs, 20 * kUs, 0.5 * kUs, 4 * kUs}; }

// The two wires, in microseconds.
class Wires {
 public:
  explicit Wires(const DriverProfile& profile, bool has_enable = false) : decoder_(profile, has_enable) {}
  Wires& enable(double at_us, bool level) {
    decoder_.enableLevel(at_us * kUs, level, steps_);
    return *this;
  }
  Wires& pul(double at_us, bool level) { return set(at_us, level, dir_); }
  Wires& dir(double at_us, bool level) { return set(at_us, pul_, level); }
  Wires& set(double at_us, bool pul_level, bool dir_level) {
    pul_ = pul_level;
    dir_ = dir_level;
    decoder_.levels(at_us * kUs, pul_, dir_, steps_);
    return *this;
  }
  Wires& pulse(double at_us, double width_us) { return pul(at_us, true).pul(at_us + width_us, false); }
  std::vector<int> directions(double at_us = 1e6) {
    decoder_.settle(at_us * kUs, steps_);
    std::vector<int> result;
    for (const StepEdge& step : steps_) result.push_back(step.direction);
    return result;
  }
  [[nodiscard]] const std::vector<StepEdge>& steps() const { return steps_; }

 private:
  PulseDecoder decoder_;
  bool pul_{false}, dir_{false};
  std::vector<StepEdge> steps_;
};

using Directions = std::vector<int>;

TEST(PulseDecoder, StepsInTheDirectionThatDirHadAtTheActiveEdge) {
  Wires wires(dm556());
  wires.pulse(100, 5).dir(120, true).pulse(140, 5).pulse(160, 5).dir(180, false).pulse(200, 5);
  EXPECT_EQ(wires.directions(), (Directions{-1, 1, 1, -1}));
}

TEST(PulseDecoder, ADriveMayStepForwardsWhileDirIsLow) {
  DriverProfile profile = dm556();
  profile.dir_low = true;
  Wires wires(profile);
  // The third pulse comes 2 us after DIR, which the latch has not seen yet.
  wires.pulse(100, 5).dir(120, true).pulse(140, 5).dir(178, false).pulse(180, 5).pulse(200, 5);
  EXPECT_EQ(wires.directions(), (Directions{1, -1, -1, 1}));
}

TEST(PulseDecoder, AStepTakesEffectOnceThePulseHasLastedItsWidth) {
  Wires wires(dm556());
  wires.pul(100, true);
  EXPECT_EQ(wires.directions(102.4).size(), 0U);
  EXPECT_EQ(wires.directions(102.5).size(), 1U);
  EXPECT_NEAR(wires.steps().front().time_s, 102.5 * kUs, 1e-15);
  EXPECT_EQ(wires.directions(1e6).size(), 1U);
}

TEST(PulseDecoder, ADirThatIsTooLateLetsTheDriveStepTheOldWay) {
  Wires wires(dm556());
  wires.dir(100, true).pulse(104.9, 5).pulse(120, 5);
  EXPECT_EQ(wires.directions(), (Directions{-1, 1}));
}

TEST(PulseDecoder, ATimeThatIsExactlyTheLimitIsLongEnough) {
  Wires wires(dm556());
  wires.dir(100, true).pulse(105, 2.5).pulse(110, 2.5).dir(120, false).pulse(125, 2.5);
  EXPECT_EQ(wires.directions(), (Directions{1, 1, -1}));
}

TEST(PulseDecoder, ATimeThatIsExactlyTheLimitIsLongEnoughAfterADayEither) {
  // The times are whole numbers of ticks of 62.5 ns: width 2.5 us, space 2.5 us, set-up 5 us and hold 10 us.
  PulseDecoder decoder(dm556());
  std::vector<StepEdge> steps;
  const TickRate rate{1, 16'000'000};
  Tick tick = 86'400ULL * 16'000'000ULL + 7;
  const auto set = [&](Tick after, bool pul, bool dir) {
    tick += after;
    decoder.levels(rate.seconds(tick), pul, dir, steps);
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
  EXPECT_EQ(steps.size(), 10000U);
}

TEST(PulseDecoder, AGlitchOfDirWithinTheSetupTimeIsOverlookedTheDriveStillKnowsTheLevelBefore) {
  Wires wires(dm556());
  wires.dir(10, true).dir(100, false).dir(101, true).pulse(102, 5);
  EXPECT_EQ(wires.directions(), (Directions{1}));
}

TEST(PulseDecoder, ADirThatChangesTooSoonAfterTheEdgeDoesNotChangeTheStep) {
  Wires wires(dm556());
  wires.dir(50, true).pulse(100, 5).dir(109.9, false);
  EXPECT_EQ(wires.directions(), (Directions{1}));
}

TEST(PulseDecoder, APulseThatIsTooShortMakesNoStep) {
  Wires wires(dm556());
  wires.pulse(100, 2.4).pulse(120, 2.6);
  EXPECT_EQ(wires.directions(), (Directions{-1}));
}

TEST(PulseDecoder, APauseThatIsTooShortMakesOnePulseOfTwo) {
  Wires wires(dm556());
  wires.pulse(100, 5).pulse(107.4, 5).pulse(120, 5);
  EXPECT_EQ(wires.directions(), (Directions{-1, -1}));
}

TEST(PulseDecoder, DirAndPulInOneWriteStepTheOldWay) {
  Wires wires(dm556());
  wires.set(100, true, true).set(105, false, true).pulse(120, 5);
  EXPECT_EQ(wires.directions(), (Directions{-1, 1}));
}

TEST(PulseDecoder, ADisabledDriveTakesNoStep) {
  Wires wires(dm556(), true);
  wires.pulse(100, 5).enable(120, true).pulse(140, 5).pulse(160, 5).enable(180, false).pulse(200, 5);
  EXPECT_EQ(wires.directions(), (Directions{-1, -1}));
}

TEST(PulseDecoder, ADriveMayBeEnabledWhileTheLineIsLow) {
  DriverProfile profile = dm556();
  profile.enable_low = true;
  Wires wires(profile, true);
  wires.pulse(100, 5).enable(120, true).pulse(140, 5).pulse(160, 5).enable(180, false).pulse(200, 5);
  EXPECT_EQ(wires.directions(), (Directions{-1, -1}));
}

TEST(PulseDecoder, APulseWithinTheSetUpOfTheEnableIsLost) {
  DriverProfile profile = dm556();
  profile.enable_setup_s = 50 * kUs;
  Wires wires(profile, true);
  wires.enable(100, true).pulse(149, 5).pulse(160, 5);
  EXPECT_EQ(wires.directions(), (Directions{-1}));
  EXPECT_NEAR(wires.steps().front().time_s, 162.5 * kUs, 1e-12);
}

TEST(PulseDecoder, AStepThatIsNotYetCertainWhenItsDriveIsDisabledIsLost) {
  Wires wires(dm556(), true);
  wires.enable(10, true).pul(100, true).enable(101, false).pul(110, false).pul(200, true);
  EXPECT_TRUE(wires.directions().empty());
  wires.pul(210, false).enable(220, true).pul(300, true).enable(303, false);
  EXPECT_EQ(wires.directions(), (Directions{-1}));
}

TEST(PulseDecoder, AnEnableThatStaysAsItIsChangesNothing) {
  DriverProfile profile = dm556();
  profile.enable_setup_s = 50 * kUs;
  Wires wires(profile, true);
  wires.enable(10, true).pul(100, true).enable(101, true).pul(110, false);
  EXPECT_EQ(wires.directions(), (Directions{-1}));
}

TEST(PulseDecoder, TheDriveWithAFallingActiveEdgeStepsWithTheFall) {
  Wires wires(gecko201());
  wires.pul(10, true).dir(20, true).pul(30, false);
  EXPECT_EQ(wires.directions(30.5), (Directions{1}));
  EXPECT_NEAR(wires.steps().front().time_s, 30.5 * kUs, 1e-15);
  wires.pul(40, true).pul(50, false).pul(60, true).dir(75, false).pul(90, false);
  EXPECT_EQ(wires.directions(), (Directions{1, 1, -1}));
}

TEST(PulseDecoder, APinThatRestsLowFromTheStartIsNoPulseOfAFallingEdgeDrive) {
  Wires wires(gecko201());
  wires.pul(10, false).dir(20, true).dir(30, false);
  EXPECT_TRUE(wires.directions().empty());
}

// Random traffic with all kinds of faults, settled every `every_us` (0: never in between).
Wires randomTraffic(const DriverProfile& profile, double every_us) {
  Wires wires(profile);
  const CounterRandom random(11, 2);
  double at_us = 5.0;
  double settled_us = 0.0;
  bool pul = false;
  bool dir = false;
  for (std::uint64_t i = 0; i < 5000; ++i) {
    at_us += std::floor(160.0 * random.uniform(2 * i)) / 16.0;
    for (; every_us > 0 && settled_us + every_us <= at_us; settled_us += every_us) {
      (void)wires.directions(settled_us + every_us);
    }
    const double which = random.uniform(2 * i + 1);
    if (which < 0.9) pul = !pul;
    if (which > 0.8) dir = !dir;
    wires.set(at_us, pul, dir);
  }
  (void)wires.directions(at_us + 100.0);
  return wires;
}

TEST(PulseDecoder, DoesNotCareHowOftenItSettles) {
  for (const DriverProfile& profile : {dm556(), gecko201()}) {
    const Wires rarely = randomTraffic(profile, 0.0);
    EXPECT_GT(rarely.steps().size(), 500U);
    for (const double every_us : {0.37, 10.0, 500.0}) {
      const Wires often = randomTraffic(profile, every_us);
      ASSERT_EQ(often.steps().size(), rarely.steps().size());
      for (std::size_t i = 0; i < rarely.steps().size(); ++i) {
        ASSERT_EQ(often.steps()[i].time_s, rarely.steps()[i].time_s);
        ASSERT_EQ(often.steps()[i].direction, rarely.steps()[i].direction);
      }
    }
  }
}

TEST(PulseDecoder, StepsComeInOrderOfTime) {
  const Wires wires = randomTraffic(dm556(), 0.0);
  EXPECT_TRUE(std::ranges::is_sorted(wires.steps(), {}, &StepEdge::time_s));
}

}  // namespace
}  // namespace kerfbench::twin
