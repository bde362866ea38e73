// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <utility>

#include "hil/live/capture_on_pins.h"
#include "hil/live/real_pins.h"
#include "hil/run/release.h"
#include "tests/hil/scenario/plate_on_pins.h"
#include "tests/hil/source/analyser/scripted_analyser.h"

namespace kerfbench::live {
namespace {

using testing::HasSubstr;

namespace fs = std::filesystem;

/// An analyser with an event while the job runs.
class EventfulAnalyser final : public source::AnalyserSystem {
 public:
  explicit EventfulAnalyser(std::function<void()> event) : event_(std::move(event)) {}
  source::ScriptedAnalyser script;
  int started{};

  source::AnalyserList list() override { return script.list(); }
  std::unique_ptr<source::AnalyserFeed> acquire(const source::AnalyserRequest& request) override {
    ++started;
    event_();
    return script.acquire(request);
  }

 private:
  std::function<void()> event_;
};

class CaptureCommandTest : public scenario::PlateOnPins {
 protected:
  void SetUp() override {
    scenario::PlateOnPins::SetUp();
    fs::create_directories(temp_.path() / "firmware");
    (void)temp_.write("firmware/linecutter-avr.hex", ":00000001FF\n");
    options.scenario = scenario(
        "time_limit_s: 10\n"
        "firmware:\n"
        "  source: analyser\n"
        "  driver: fx2lafw\n"
        "  samplerate_hz: 24000000\n"
        "  lines:\n"
        "    galvo_x_pul: D0\n"
        "    galvo_x_dir: D1\n"
        "    galvo_y_pul: D2\n"
        "    galvo_y_dir: D3\n"
        "    laser_gate: D4\n"
        "    laser_pwm: D5\n");
    options.out = temp_.path() / "out" / "heard";
    options.session = true;
    options.quiet = true;
    options.bin_dir = temp_.path() / "bin";
    analyser->script.runs = {{24'000, 0}, {240, 1}, {240'000'000, 0}};
    pins.analysers = analyser;
  }
  int capture() { return captureOnPins(pins, options); }

  CaptureOptions options;
  std::function<void()> meanwhile = [] {};
  const std::shared_ptr<EventfulAnalyser> analyser =
      std::make_shared<EventfulAnalyser>([this] { meanwhile(); });
  RealPins pins;
};

TEST_F(CaptureCommandTest, ASessionIsWrittenBesideTheRecording) {
  EXPECT_EQ(capture(), 0);
  EXPECT_TRUE(fs::is_regular_file(options.out / "pins.vcd"));
  EXPECT_TRUE(fs::is_regular_file(options.out / "pins.sr"));
}

TEST_F(CaptureCommandTest, ASessionThatCouldBeTooLongIsRefusedBeforeTheJob) {
  options.time_limit_s = 2'863.4;  // The limit is 2^36 samples, 2863.31 s.
  try {
    (void)capture();
    FAIL();
  } catch (const base::InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("s.yaml: --sr: 2863.4 s at 24000000 Hz may be more samples than"));
  }
  EXPECT_EQ(analyser->started, 0);
  options.session = false;
  EXPECT_EQ(capture(), 0);
  options.session = true;
  options.time_limit_s = 2'863.0;
  EXPECT_EQ(capture(), 0);
}

TEST_F(CaptureCommandTest, ASessionThatCannotBeWrittenCostsNothingElse) {
  meanwhile = [this] {
    for (const auto& staging : fs::directory_iterator(options.out.parent_path()))
      fs::create_directories(staging.path() / "pins.sr" / "in the way");
  };
  testing::internal::CaptureStdout();
  EXPECT_EQ(capture(), 2);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr("no pins.sr: "));
  EXPECT_THAT(base::contentOf(options.out / "pins.vcd"), HasSubstr("galvo_x_pul"));
  EXPECT_TRUE(fs::is_regular_file(options.out / "scenario.yaml"));
}

}  // namespace
}  // namespace kerfbench::live
