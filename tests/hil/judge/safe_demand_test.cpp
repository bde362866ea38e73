// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/safe_demand.h"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

namespace kerfbench::judge {
namespace {

constexpr TickRate kControllerRate{1, 16'000'000};

/// A host that starves a controller, whose axes make their pulses where the test puts them.
class Starved : public ::testing::Test {
 protected:
  Starved() {
    test_case.scenario.provoke.cause = scenario::ProvokeChoice::Cause::kHostStarves;
    map.assign(Signal::kGalvoXPul, {0, 0});
    map.assign(Signal::kGalvoXDir, {0, 1});
    map.assign(Signal::kGalvoYPul, {0, 2});
    map.assign(Signal::kGalvoYDir, {0, 3});
    recording.rate = kControllerRate;
  }

  void pulse(unsigned bit, Tick tick) {
    const auto level = static_cast<std::uint16_t>(1U << bit);
    recording.outputs.push_back({tick, 0, level, level, 0});
    recording.outputs.push_back({tick + 100, 0, level, 0, 0});
  }

  [[nodiscard]] double cause_s() const {
    return safeStateDemand(test_case, job, controller::PulseCounter(recording, map), 0.0).cause_s;
  }

  scenario::Case test_case;
  run::PreparedJob job;
  SignalMap map;
  source::PinRecording recording;
};

TEST_F(Starved, TheLastStepSentIsTheLastOfAnyAxis) {
  pulse(0, 1000);
  pulse(2, 2000);
  pulse(0, 9000);  // X makes its last step after Y's.
  job.starved = {{Signal::kGalvoXPul, 2}, {Signal::kGalvoYPul, 1}};
  EXPECT_EQ(cause_s(), kControllerRate.seconds(9000));
  job.starved = {{Signal::kGalvoXPul, 1}, {Signal::kGalvoYPul, 1}};
  EXPECT_EQ(cause_s(), kControllerRate.seconds(2000));
}

TEST_F(Starved, StepsThatNobodySentDoNotCount) {
  pulse(0, 1000);
  pulse(2, 2000);
  pulse(2, 5000);
  job.starved = {{Signal::kGalvoXPul, 1}, {Signal::kGalvoYPul, 1}};
  EXPECT_EQ(cause_s(), kControllerRate.seconds(2000));
}

TEST_F(Starved, AStepThatNeverCameLeavesNoCause) {
  pulse(0, 1000);
  job.starved = {{Signal::kGalvoXPul, 1}, {Signal::kGalvoYPul, 1}};
  EXPECT_TRUE(std::isnan(cause_s()));
  job.starved = {{Signal::kGalvoYPul, 1}, {Signal::kGalvoXPul, 1}};
  EXPECT_TRUE(std::isnan(cause_s()));
  job.starved = {};
  EXPECT_TRUE(std::isnan(cause_s()));
}

}  // namespace
}  // namespace kerfbench::judge
