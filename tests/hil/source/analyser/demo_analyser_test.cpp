// SPDX-License-Identifier: Apache-2.0
// libsigrok itself, by its demo driver, whose patterns are known to the sample.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/source/analyser/capture.h"

namespace kerfbench::source {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

class DemoAnalyser : public testing::Test {
 protected:
  DemoAnalyser() {
    map.assign(Signal::kGalvoXPul, {0, 0});
    map.assign(Signal::kGalvoXDir, {0, 1});
    options.request.driver = "demo";
    options.request.samplerate_hz = 1'000'000;
    // The demo driver fills the first n channels if n are on, whichever they are.
    options.request.channels = {"D0", "D1"};
    options.signals = {Signal::kGalvoXPul, Signal::kGalvoXDir};
    options.time_limit_s = 0.02;
  }
  PinCapture capture(const std::string& pattern) {
    options.request.settings = {{"pattern", pattern}};
    return captureAnalyser(options, map, *analysers);
  }
  std::string refusal() {
    try {
      (void)captureAnalyser(options, map, *analysers);
    } catch (const AnalyserError& e) {
      return e.what();
    }
    return {};
  }
  SignalMap map;
  AnalyserCaptureOptions options;
  const std::shared_ptr<AnalyserSystem> analysers = sigrokAnalysers(KERFBENCH_BIN_DIR);
};

// The pattern is a byte that counts: D0 changes with each sample, D1 with each second.
TEST_F(DemoAnalyser, CountsUpSampleBySample) {
  const PinCapture captured = capture("incremental");
  EXPECT_EQ(captured.edges, 19'999U + 9'999U);
  const std::vector<PinEvent> outputs = captured.recording.outputs.unpacked();
  ASSERT_EQ(outputs.size(), 20'000U);  // One event is the mark of the problem.
  for (std::uint16_t i = 1; i < 20'000; ++i) {
    // The tick of sample 0 is 1.
    const std::uint16_t d1 = i % 2 == 0 ? 2 : 0;
    const auto level = static_cast<std::uint16_t>(i & 3U);
    ASSERT_EQ(outputs[i - 1U], (PinEvent{i + 1U, 0, static_cast<std::uint16_t>(1U | d1), level, 0})) << i;
  }
  EXPECT_THAT(captured.recording.problems, ElementsAre(HasSubstr("the pins were not quiet")));
  EXPECT_EQ(capture("incremental").recording.outputs, outputs) << "the same again";
}

// The pattern has one high channel of eight, then none: a period of nine.
TEST_F(DemoAnalyser, WalksAlongItsChannels) {
  const PinCapture captured = capture("walking-one");
  std::uint64_t pulses = 0;
  for (const PinEvent& event : captured.recording.outputs) {
    if ((event.changed & event.level & 1U) == 0) continue;
    EXPECT_EQ((event.tick - 1) % 9, 1U);
    ++pulses;
  }
  EXPECT_EQ(pulses, 2223U);
}

TEST_F(DemoAnalyser, StaysLow) {
  const PinCapture captured = capture("all-low");
  EXPECT_EQ(captured.edges, 0U);
  EXPECT_THAT(captured.recording.problems, ElementsAre(HasSubstr("no edge came within 0.02 s")));
}

TEST_F(DemoAnalyser, StaysHigh) {
  options.at_start.low = {Signal::kGalvoXPul};
  EXPECT_THAT(capture("all-high").recording.problems,
              ElementsAre(HasSubstr("galvo_x_pul is high at the start"), HasSubstr("no edge came")));
}

TEST_F(DemoAnalyser, RefusesWhatItDoesNotHaveAndSaysWhatThereIs) {
  const AnalyserCaptureOptions good = options;
  const auto refused = [&](auto change) {
    options = good;
    change(options.request);
    return refusal();
  };
  EXPECT_THAT(refused([](AnalyserRequest& w) {
                w.channels = {"D8", "CLK"};
              }),
              HasSubstr("it has no channel 'D8', 'CLK'; it has D0 D1 D2 D3 D4 D5 D6 D7"));
  EXPECT_THAT(refused([](AnalyserRequest& w) { w.driver = "demon"; }),
              AllOf(HasSubstr("no driver 'demon'"), HasSubstr(" demo "), HasSubstr(" fx2lafw ")));
  EXPECT_THAT(refused([](AnalyserRequest& w) { w.serial = "5"; }),
              AllOf(HasSubstr("no analyser with the serial 5"), HasSubstr("Demo device")));
  EXPECT_THAT(refused([](AnalyserRequest& w) { w.conn = "1.14"; }), HasSubstr("no analyser at 1.14"));
  EXPECT_THAT(refused([](AnalyserRequest& w) {
                w.settings = {{"pattern", "plaid"}};
              }),
              HasSubstr("setting pattern: plaid: not taken"));
  EXPECT_THAT(refused([](AnalyserRequest& w) {
                w.settings = {{"colour", "red"}};
              }),
              HasSubstr("no setting of this name"));
  EXPECT_THAT(refused([](AnalyserRequest& w) {
                w.settings = {{"voltage_threshold", "1.2-1.2"}};
              }),
              HasSubstr("has no such setting"));
  EXPECT_THAT(refused([](AnalyserRequest& w) {
                w.settings = {{"averaging", "maybe"}};
              }),
              HasSubstr("no value for it"));
}

TEST_F(DemoAnalyser, IsListed) {
  const AnalyserList list = analysers->list();
  EXPECT_THAT(list.library, HasSubstr("libsigrok 0."));
  EXPECT_THAT(list.drivers, Contains("fx2lafw"));
  const auto demo = std::ranges::find(list.devices, "demo", &AnalyserDevice::driver);
  ASSERT_NE(demo, list.devices.end());
  EXPECT_EQ(demo->name, "Demo device");
  EXPECT_EQ(demo->samplerates, "1 Hz … 1000000000 Hz in steps of 1 Hz");
  EXPECT_THAT(demo->channels, ElementsAre("D0", "D1", "D2", "D3", "D4", "D5", "D6", "D7"));
}

}  // namespace
}  // namespace kerfbench::source
