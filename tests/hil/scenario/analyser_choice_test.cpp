// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/analyser_choice.h"
#include "hil/live/capture_on_pins.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/live/analyser_capture.h"
#include "hil/run/release.h"
#include "tests/hil/scenario/plate_on_pins.h"
#include "tests/hil/source/analyser/scripted_analyser.h"

namespace kerfbench::scenario {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kWires =
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
    "    laser_pwm: D5\n";

class AnalyserChoiceTest : public PlateOnPins {};

TEST_F(AnalyserChoiceTest, TheSameScenarioRunsOnAnAnalyser) {
  const Case test_case = plate(std::string(kWires) +
                               "  conn: 1.14\n  serial: \"0007\"\n  quiet_s: 3\n"
                               "  settings: {voltage_threshold: 1.2-1.2}\n");
  EXPECT_TRUE(test_case.scenario.firmware.onRealPins());
  const source::AnalyserCaptureOptions options = captureOptions(test_case.scenario.firmware.analyser);
  EXPECT_EQ(options.request.driver, "fx2lafw");
  EXPECT_EQ(options.request.conn, "1.14");
  EXPECT_EQ(options.request.serial, "0007");
  EXPECT_EQ(options.request.samplerate_hz, 24'000'000U);
  EXPECT_THAT(options.request.channels, ElementsAre("D0", "D1", "D2", "D3", "D4", "D5"));
  EXPECT_EQ(options.signals[4], Signal::kLaserGate);
  EXPECT_THAT(options.request.settings, ElementsAre(std::pair("voltage_threshold", "1.2-1.2")));
  EXPECT_EQ(options.quiet_s, 3.0);
  EXPECT_THROW((void)run::openRelease(test_case.scenario.firmware, temp_.path()), base::InputError);
}

TEST_F(AnalyserChoiceTest, WhatIsMissingIsAskedFor) {
  EXPECT_THAT(faultsIn("firmware: {source: analyser}\n"),
              AllOf(HasSubstr("firmware.driver"), HasSubstr("firmware.samplerate_hz")));
  EXPECT_THAT(faultsIn(base::replaced(kWires, "    laser_gate: D4\n", "")),
              HasSubstr("s.yaml:5: firmware.driver: firmware.lines has no line for laser_gate"));
  EXPECT_THAT(faultsIn(std::string(kWires) + "belt: {speed_mm_s: 60}\n"),
              HasSubstr("speed_mm_s must be 0 where an analyser listens"));
}

TEST_F(AnalyserChoiceTest, AScenarioOnAGpiochipIsExtended) {
  (void)temp_.write("gpio.yaml", "extends: " + base::fixture("scenarios/line-ok/plate.yaml").string() +
                                     "\nfirmware: {source: gpio, chip: gpiochip0, stamp_err_us: 30}\n");
  const auto path = temp_.write("s.yaml", std::string("extends: gpio.yaml\nname: on-pins\n") + kWires);
  EXPECT_EQ(readCase(path, temp_.path()).scenario.firmware.source, FirmwareChoice::Source::kAnalyser);
}

TEST_F(AnalyserChoiceTest, AScenarioWhoseInputsAreDrivenIsRefusedInWords) {
  (void)temp_.write(
      "gpio.yaml",
      "extends: " + base::fixture("scenarios/line-ok/plate.yaml").string() +
          "\nfirmware: {source: gpio, chip: gpiochip0, stamp_err_us: 30, uart: "
          "/dev/ttyUSB0, uart_wait_s: 2, uart_delay_ms: 9, outputs: {interlock: 16}, max_lag_us: 9}\n");
  const auto path = temp_.write("s.yaml", std::string("extends: gpio.yaml\nname: on-pins\n") + kWires);
  try {
    (void)readCase(path, temp_.path());
    FAIL() << "nothing was wrong";
  } catch (const base::ConfigError& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("gpio.yaml:2: firmware.outputs: is for source: gpio"),
                                HasSubstr("gpio.yaml:2: firmware.uart: is for source: gpio"),
                                Not(HasSubstr("unknown")), Not(HasSubstr("uart_wait_s")),
                                Not(HasSubstr("uart_delay_ms")), Not(HasSubstr("max_lag_us"))));
  }
}

// The rate must give four samples of the shortest pulse that a drive takes: here 2.5 us.
TEST_F(AnalyserChoiceTest, ARateThatIsTooLowForAPulseIsAFaultThatSaysWhichIsEnough) {
  twin::MachineDescription machine = plate(kWires).machine;
  machine.galvo_x.profile.width_s = 2.5e-6;
  machine.galvo_x.profile.space_s = 5e-6;
  machine.galvo_y.profile.width_s = machine.galvo_y.profile.space_s = 0.0;
  AnalyserChoice choice = plate(kWires).scenario.firmware.analyser;
  choice.samplerate_hz = 1'600'000;
  EXPECT_EQ(faultsOf(choice, machine), "");
  choice.samplerate_hz = 1'599'999;
  EXPECT_THAT(faultsOf(choice, machine),
              AllOf(HasSubstr("s.yaml:6: firmware.samplerate_hz: 1599999 Hz is too low for galvo_x_pul"),
                    HasSubstr("pulses of 2.5 us, and 4 samples of each need at least 1600000 Hz"),
                    Not(HasSubstr("galvo_y"))));
  machine.galvo_x.profile.width_s = 0.0;  // The data sheet states no width.
  choice.samplerate_hz = 799'999;
  EXPECT_THAT(faultsOf(choice, machine), HasSubstr("at least 800000 Hz"));
  EXPECT_THAT(faultsIn(base::withValue(kWires, "samplerate_hz", "100000")),
              HasSubstr("100000 Hz is too low"));
}

TEST_F(AnalyserChoiceTest, ItIsListenedToForAsLongAsTheScenarioSays) {
  const Case test_case = plate(std::string(kWires) + "  quiet_s: 0.5\ntime_limit_s: 4\n");
  source::ScriptedAnalyser analyser;
  analyser.runs = {{24'000'000, 0b000}, {240, 0b001}, {24'000'000, 0}};
  base::Console console(true);
  const source::PinCapture captured = live::captureAnalyserCase(test_case, analyser, console);
  EXPECT_EQ(analyser.requested.listen.limit_samples, 96'000'000U);
  EXPECT_EQ(analyser.requested.listen.quiet_samples, 12'000'000U);
  EXPECT_EQ(captured.edges, 2U);
  // A PUL that rests high is allowed by some drives.
  analyser.runs = {{24'000'000, 0b001}, {240, 0b000}, {24'000'000, 1}};
  const bool rising = test_case.machine.galvo_x.profile.active_edge_rising;
  const auto problems = live::captureAnalyserCase(test_case, analyser, console).recording.problems;
  EXPECT_EQ(problems.size(), rising ? 1U : 0U);
  analyser.refusal = "it is gone";
  try {
    (void)live::captureAnalyserCase(test_case, analyser, console);
    FAIL();
  } catch (const base::InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("s.yaml:5: firmware.driver: it is gone"));
  }
}

}  // namespace
}  // namespace kerfbench::scenario
