// SPDX-License-Identifier: Apache-2.0
#include "hil/live/pin_statistics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kerfbench::live {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr TickRate kMicroseconds{1, 1'000'000};

SignalMap pulAndGate() {
  SignalMap map;
  map.assign(Signal::kGalvoXPul, {0, 3});
  map.assign(Signal::kLaserGate, {1, 0});
  map.assign(Signal::kEncoderA, {2, 0});
  return map;
}

TEST(PinStatistics, CountsEdgesRatesAndSilence) {
  source::PinRecording recording;
  recording.rate = kMicroseconds;
  recording.outputs = {{100, 0, 8, 8, 0},  {150, 0, 8, 0, 0},  {500, 0, 8, 8, 0},   {2000, 1, 1, 1, 0},
                       {6000, 0, 8, 0, 0}, {6000, 1, 1, 0, 0}, {7000, 0, 16, 16, 0}};
  const PinStatistics heard = pinStatistics(recording, pulAndGate());
  ASSERT_EQ(heard.lines.size(), 2U) << "a sensor is none of the controller's";
  EXPECT_EQ(heard.lines[0].signal, Signal::kGalvoXPul);
  EXPECT_EQ(heard.lines[0].edges, 4U);
  EXPECT_DOUBLE_EQ(heard.lines[0].shortest_s, 50e-6);
  EXPECT_DOUBLE_EQ(heard.lines[0].peak_hz, 3000.0);
  EXPECT_EQ(heard.lines[1].edges, 2U);
  EXPECT_EQ(heard.edges, 6U);
  EXPECT_DOUBLE_EQ(heard.span_s, 5.9e-3);
  EXPECT_DOUBLE_EQ(heard.longest_silence_s, 4e-3);
  EXPECT_THAT(pinStatisticsText(heard),
              AllOf(HasSubstr("galvo_x_pul             4 edges, at most 3000 per second"),
                    HasSubstr("two within 50 us"), HasSubstr("6 edges in 0.006 s")));
}

// A line that is high at the start has not moved.
TEST(PinStatistics, LevelsAtTheStartAndMarksOfGapsAreNoEdges) {
  source::PinRecording recording;
  recording.rate = kMicroseconds;
  recording.outputs = {{1, 0, 8, 8, 0}, {900, 0, 0, 8, PinEvent::kGap}};
  const PinStatistics heard = pinStatistics(recording, pulAndGate());
  EXPECT_EQ(heard.edges, 0U);
  EXPECT_EQ(heard.span_s, 0.0);
  EXPECT_THAT(pinStatisticsText(heard), HasSubstr("0 edges in 0.000 s"));
}

}  // namespace
}  // namespace kerfbench::live
