// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/pin_stamps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace kerfbench::judge {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

PulseTiming timingWith(double setup_s, std::uint64_t violations) {
  PulseTiming timing;
  timing.axis = "galvo_x";
  timing.profile.setup_s = 5e-6;
  timing.pulses = 100;
  timing.setup_violations = violations;
  timing.min_setup_s = setup_s;
  timing.min_hold_s = timing.min_width_s = timing.min_space_s = std::numeric_limits<double>::infinity();
  return timing;
}

TEST(PinStamps, AViolationWithinTheStampsErrorIsNotProven) {
  const PulseTiming pulses[] = {timingWith(3e-6, 2)};
  EXPECT_THAT(unprovenSteps(pulses, 1.1e-6), ElementsAre(HasSubstr("galvo_x: the DIR set-up is 3 us")));
  EXPECT_THAT(unprovenSteps(pulses, 0.9e-6), IsEmpty());
  EXPECT_THAT(unprovenSteps(pulses, 0.0), IsEmpty());
}

TEST(PinStamps, ATimeThatIsKeptIsNoMatter) {
  const PulseTiming pulses[] = {timingWith(5.1e-6, 0)};
  EXPECT_THAT(unprovenSteps(pulses, 1e-3), IsEmpty());
}

TEST(PinStamps, EachOfTheFourTimesIsLookedAt) {
  PulseTiming timing = timingWith(3e-6, 1);
  timing.profile.hold_s = timing.profile.width_s = timing.profile.space_s = 5e-6;
  timing.hold_violations = timing.width_violations = timing.space_violations = 1;
  timing.min_hold_s = timing.min_width_s = timing.min_space_s = 4e-6;
  const PulseTiming pulses[] = {timing};
  EXPECT_THAT(unprovenSteps(pulses, 30e-6), ElementsAre(HasSubstr("DIR set-up"), HasSubstr("DIR hold"),
                                                        HasSubstr("pulse width"), HasSubstr("pulse space")));
}

TEST(PinStamps, TheUncertaintyOfAnEdgeIsThatOfARectangle) {
  source::PinRecording recording;
  recording.rate = {1, 1'000'000'000};
  EXPECT_EQ(pinUncertainty_s(recording), 0.0);
  recording.stamp_err_ticks = 30'000;
  EXPECT_NEAR(pinUncertainty_s(recording), 30e-6 / std::sqrt(3.0), 1e-15);
}

}  // namespace
}  // namespace kerfbench::judge
