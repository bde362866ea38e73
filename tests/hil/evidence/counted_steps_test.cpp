// SPDX-License-Identifier: Apache-2.0
#include "hil/evidence/counted_steps.h"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "hil/evidence/pin_evidence.h"
#include "twin/base/pin_event.h"

namespace kerfbench::evidence {
namespace {

constexpr std::uint16_t kPulX = 1;
constexpr std::uint16_t kDirX = 2;
constexpr std::uint16_t kPulY = 4;
constexpr std::uint16_t kDirY = 8;

PinWiring wiring(bool rising = true) {
  PinWiring wiring;
  wiring.signals.assign(Signal::kGalvoXPul, {0, 0});
  wiring.signals.assign(Signal::kGalvoXDir, {0, 1});
  wiring.signals.assign(Signal::kGalvoYPul, {0, 2});
  wiring.signals.assign(Signal::kGalvoYDir, {0, 3});
  DriverProfile drive;
  drive.active_edge_rising = rising;
  wiring.drives = {{"galvo_x", Signal::kGalvoXPul, Signal::kGalvoXDir, drive},
                   {"galvo_y", Signal::kGalvoYPul, Signal::kGalvoYDir, drive}};
  return wiring;
}

/// Levels of port 0 over time, in ticks of a microsecond.
source::PinRecording recordingOf(const std::vector<std::pair<Tick, std::uint16_t>>& writes) {
  source::PinRecording recording;
  recording.rate = {1, 1'000'000};
  std::uint16_t before = 0;
  for (const auto& [tick, level] : writes) {
    recording.outputs.push_back({tick, 0, static_cast<std::uint16_t>(before ^ level), level, 0});
    before = level;
  }
  recording.end = 10'000;
  return recording;
}

TEST(CountedSteps, CountUpWhileDirIsHighAndDownWhileItIsLow) {
  const auto steps = CountedSteps::of(recordingOf({{110, kDirX},
                                                   {120, kDirX | kPulX},
                                                   {130, kDirX},
                                                   {140, kDirX | kPulX | kPulY},
                                                   {150, kDirY},
                                                   {360, kDirY | kPulY},
                                                   {370, 0},
                                                   {380, kPulX},
                                                   {390, kPulX}}),
                                      wiring());
  ASSERT_TRUE(steps);
  EXPECT_EQ(steps->at(-1.0), (CountedSteps::Steps{0, 0}));
  EXPECT_EQ(steps->at(50e-6), (CountedSteps::Steps{0, 0}));
  EXPECT_EQ(steps->at(150e-6), (CountedSteps::Steps{2, -1}));
  EXPECT_EQ(steps->at(250e-6), (CountedSteps::Steps{2, -1})) << "nothing happens in this period";
  EXPECT_EQ(steps->at(350e-6), (CountedSteps::Steps{1, 0}));
  EXPECT_EQ(steps->at(9.0), (CountedSteps::Steps{1, 0})) << "after the last edge";
}

TEST(CountedSteps, CountTheSameWhileTheRunGoesOn) {
  std::vector<std::pair<Tick, std::uint16_t>> writes;
  std::uint32_t random = 1;
  for (Tick tick = 20; tick < 9'000; tick += 1 + random % 41) {
    random = random * 1664525U + 1013904223U;
    writes.emplace_back(tick, static_cast<std::uint16_t>(random >> 28U));
  }
  const source::PinRecording recording = recordingOf(writes);
  const auto whole = CountedSteps::of(recording, wiring());
  for (const Tick quantum : {7U, 100U, 333U, 10'000U}) {
    auto steps = CountedSteps::from(recording.rate, wiring());
    ASSERT_TRUE(steps);
    auto next = recording.outputs.begin();
    for (Tick now = quantum; now < recording.end + quantum; now += quantum) {
      std::vector<PinEvent> events;
      for (; next != recording.outputs.end() && next->tick <= now; ++next) events.push_back(*next);
      steps->add(events, now);
      // What has been added is told as it will be in the end.
      const double known_s = recording.rate.seconds(now) - CountedSteps::kKnownAfter_s;
      if (known_s < 0.0) continue;
      EXPECT_EQ(steps->at(known_s), whole->at(known_s)) << quantum << " at " << now;
    }
    steps->end();
    for (Tick tick = 0; tick < 12'000; tick += 50)
      EXPECT_EQ(steps->at(1e-6 * static_cast<double>(tick)), whole->at(1e-6 * static_cast<double>(tick)));
  }
}

TEST(CountedSteps, ADriveThatStepsOnTheFallingEdgeCountsThat) {
  const auto steps = CountedSteps::of(recordingOf({{110, kDirX | kPulX}, {220, kDirX}, {330, kDirX | kPulX}}),
                                      wiring(false));
  ASSERT_TRUE(steps);
  EXPECT_EQ(steps->at(150e-6)[0], 0);
  EXPECT_EQ(steps->at(250e-6)[0], 1);
  EXPECT_EQ(steps->at(350e-6)[0], 1);
}

TEST(CountedSteps, ADriveThatGoesForwardsWhileDirIsLowCountsSo) {
  PinWiring inverted = wiring();
  inverted.drives[0].profile.dir_low = true;
  const auto steps = CountedSteps::of(
      recordingOf({{110, kPulX | kPulY}, {120, 0}, {130, kPulX}, {140, kDirX}, {250, kDirX | kPulX}}),
      inverted);
  ASSERT_TRUE(steps);
  EXPECT_EQ(steps->at(150e-6), (CountedSteps::Steps{2, -1}));
  EXPECT_EQ(steps->at(350e-6), (CountedSteps::Steps{1, -1}));
}

TEST(CountedSteps, ADisabledDriveCountsNothing) {
  constexpr std::uint16_t kEnable = 16;
  PinWiring enabled = wiring();
  enabled.signals.assign(Signal::kGalvoXEnable, {0, 4});
  enabled.signals.assign(Signal::kGalvoYEnable, {0, 4});
  enabled.drives[1].profile.enable_low = true;
  const auto steps = CountedSteps::of(recordingOf({{110, kPulX | kPulY},
                                                   {120, 0},
                                                   {210, kEnable},
                                                   {220, kEnable | kPulX | kPulY},
                                                   {230, kEnable},
                                                   {310, kPulX | kPulY}}),
                                      enabled);
  ASSERT_TRUE(steps);
  EXPECT_EQ(steps->at(150e-6), (CountedSteps::Steps{0, -1}));
  EXPECT_EQ(steps->at(250e-6), (CountedSteps::Steps{-1, -1}));
  EXPECT_EQ(steps->at(350e-6), (CountedSteps::Steps{-1, -2})) << "disabled and pulsed in one write";
}

TEST(CountedSteps, AnAxisWithoutItsLinesIsNotCounted) {
  PinWiring one = wiring();
  one.signals = SignalMap{};
  one.signals.assign(Signal::kGalvoXPul, {0, 0});
  one.signals.assign(Signal::kGalvoXDir, {0, 1});
  one.signals.assign(Signal::kGalvoYPul, {0, 2});
  EXPECT_FALSE(CountedSteps::of(recordingOf({}), one));
  one.signals.assign(Signal::kGalvoYDir, {0, 3});
  EXPECT_TRUE(CountedSteps::of(recordingOf({}), one));
  one.drives.pop_back();
  EXPECT_FALSE(CountedSteps::of(recordingOf({}), one));
}

}  // namespace
}  // namespace kerfbench::evidence
