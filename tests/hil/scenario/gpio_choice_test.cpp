// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/gpio_choice.h"
#include "hil/live/capture_on_pins.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/run/dialogs.h"
#include "hil/run/release.h"
#include "tests/hil/scenario/plate_on_pins.h"

namespace kerfbench::scenario {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kWires =
    "firmware:\n"
    "  source: gpio\n"
    "  chip: gpiochip3\n"
    "  stamp_err_us: 30\n"
    "  lines:\n"
    "    galvo_x_pul: 4\n"
    "    galvo_x_dir: DIR_X\n"
    "    galvo_y_pul: 6\n"
    "    galvo_y_dir: 7\n"
    "    laser_gate: 8\n"
    "    laser_pwm: 9\n";

constexpr const char* kOutputs = "  outputs: {encoder_a: 1, encoder_b: 2, print_mark: 3}\n";

class GpioChoiceTest : public PlateOnPins {
 protected:
  static source::GpioChipList chips() {
    source::GpioChipInfo chip{"/dev/gpiochip3", "gpiochip3", "sim", {}};
    for (std::uint32_t i = 0; i < 12; ++i)
      chip.lines.push_back({i, i == 5 ? "DIR_X" : "", "", false, false, false});
    return {{chip}, {}};
  }
};

TEST_F(GpioChoiceTest, TheSameScenarioRunsOnRealPins) {
  const Case test_case = plate(kWires);
  const FirmwareChoice& firmware = test_case.scenario.firmware;
  EXPECT_EQ(firmware.source, FirmwareChoice::Source::kGpio);
  EXPECT_EQ(firmware.gpio.chip, "gpiochip3");
  EXPECT_DOUBLE_EQ(firmware.gpio.stamp_err_s, 30e-6);
  EXPECT_DOUBLE_EQ(firmware.gpio.quiet_s, 2.0);
  const source::GpioCaptureOptions options = captureOptions(firmware.gpio, chips());
  EXPECT_EQ(options.chip, "/dev/gpiochip3");
  ASSERT_EQ(options.wires.size(), 6U);
  EXPECT_EQ(options.wires[1].signal, Signal::kGalvoXDir);
  EXPECT_EQ(options.wires[1].offset, 5U);
  EXPECT_EQ(run::prepareJob(test_case).dialog, nullptr);
}

TEST_F(GpioChoiceTest, WhatIsMissingIsAskedFor) {
  const std::string faults = faultsIn("firmware: {source: gpio}\n");
  EXPECT_THAT(faults, AllOf(HasSubstr("firmware.chip"), HasSubstr("firmware.stamp_err_us")));
}

TEST_F(GpioChoiceTest, EveryOutputThatTheMachineHasNeedsALine) {
  const std::string faults =
      faultsIn(base::replaced(base::replaced(kWires, "    galvo_y_dir: 7\n", ""), "    laser_gate: 8\n", ""));
  EXPECT_THAT(faults, AllOf(HasSubstr("s.yaml:5: firmware.chip: firmware.lines has no line for galvo_y_dir"),
                            HasSubstr("no line for laser_gate"), Not(HasSubstr("galvo_x_pul"))));
}

TEST_F(GpioChoiceTest, LinesThatMakeNoSenseAreFaultsWithFileAndLine) {
  const std::string faults = faultsIn(std::string(kWires) +
                                      "    gantry_x_pul: 10\n"
                                      "    encoder_a: 11\n"
                                      "    galvo_z_pul: 1\n");
  EXPECT_THAT(
      faults,
      AllOf(HasSubstr("s.yaml:15: firmware.lines.encoder_a: is an input of the controller: it belongs to "
                      "firmware.outputs"),
            HasSubstr("s.yaml:16: firmware.lines.galvo_z_pul: unknown key")));
  EXPECT_THAT(faultsOf(plate(kWires).scenario.firmware.gpio, {}, {}),
              HasSubstr("s.yaml:8: firmware.lines.galvo_x_pul: the machine has no such pin"));
  SignalMap with_gantry = plate(kWires).machine.signals;
  with_gantry.assign(Signal::kGantryXPul, {0, 4});
  EXPECT_THAT(faultsOf(plate(kWires).scenario.firmware.gpio, with_gantry, {.gantry = true}),
              HasSubstr("no line for gantry_x_pul"));
  EXPECT_THAT(faultsIn(base::replaced(kWires, "laser_gate: 8", "laser_gate: 7")),
              HasSubstr("s.yaml:12: firmware.lines.laser_gate: has line 7, and so has galvo_y_dir"));
}

TEST_F(GpioChoiceTest, APinThatEnablesSeveralDrivesIsReadOnce) {
  const Case test_case = plate(kWires);
  SignalMap enabled = test_case.machine.signals;
  enabled.assign(Signal::kGalvoXEnable, {1, 7});
  enabled.assign(Signal::kGalvoYEnable, {1, 7});
  GpioChoice choice = test_case.scenario.firmware.gpio;
  EXPECT_THAT(faultsOf(choice, enabled, {}),
              AllOf(HasSubstr("no line for galvo_x_enable"), Not(HasSubstr("galvo_y_enable"))));
  choice.lines.push_back({Signal::kGalvoXEnable, "11", "s.yaml:15: firmware.lines.galvo_x_enable"});
  EXPECT_EQ(faultsOf(choice, enabled, {}), "");
  choice.lines.push_back({Signal::kGalvoYEnable, "12", "s.yaml:16: firmware.lines.galvo_y_enable"});
  EXPECT_THAT(
      faultsOf(choice, enabled, {}),
      HasSubstr("s.yaml:16: firmware.lines.galvo_y_enable: the machine has this pin for another enable"));
}

// A controller that follows the belt would see it at rest.
TEST_F(GpioChoiceTest, ABeltThatMovesNeedsItsSensorsDriven) {
  const std::string moving = std::string(kWires) + "belt: {speed_mm_s: 60}\n";
  EXPECT_THAT(faultsIn(moving),
              AllOf(HasSubstr("s.yaml:5: firmware.chip: firmware.outputs has no line for encoder_a"),
                    HasSubstr("no line for encoder_b"), HasSubstr("no line for print_mark")));
  EXPECT_EQ(faultsIn(moving.substr(0, moving.find("belt:")) + kOutputs + "belt: {speed_mm_s: 60}\n"), "");
  EXPECT_THAT(faultsIn(std::string(kWires) + kOutputs + "belt: {drive: controller}\n"),
              HasSubstr("belt: drive must be line on real pins"));
}

TEST_F(GpioChoiceTest, WhatIsDrivenIsReadWithItsChipItsLimitAndTheSerialLine) {
  const GpioChoice quiet = plate(kWires).scenario.firmware.gpio;
  EXPECT_FALSE(quiet.isLive());
  const Case test_case = plate(std::string(kWires) + kOutputs +
                               "  out_chip: gpiochip4\n"
                               "  max_lag_us: 250\n"
                               "  uart: /dev/ttyUSB0\n"
                               "  uart_wait_s: 2\n"
                               "  uart_delay_ms: 5\n"
                               "  baud: 115200\n");
  const FirmwareChoice& firmware = test_case.scenario.firmware;
  EXPECT_TRUE(firmware.gpio.isLive());
  EXPECT_EQ(firmware.dialog, FirmwareChoice::Dialog::kLineOk);
  EXPECT_EQ(firmware.baud, 115'200U);
  EXPECT_EQ(firmware.gpio.uart, "/dev/ttyUSB0");
  EXPECT_DOUBLE_EQ(firmware.gpio.uart_wait_s, 2.0);
  EXPECT_DOUBLE_EQ(firmware.gpio.uart_delay_s, 5e-3);
  EXPECT_DOUBLE_EQ(quiet.uart_delay_s, 20e-3);
  EXPECT_DOUBLE_EQ(firmware.gpio.max_lag_s.value(), 250e-6);
  source::GpioChipList list = chips();
  list.chips.push_back({"/dev/gpiochip4", "gpiochip4", "other", list.chips[0].lines});
  const source::GpioLiveOptions options = liveOptions(firmware.gpio, list);
  EXPECT_EQ(options.in.chip, "/dev/gpiochip3");
  EXPECT_EQ(options.out_chip, "/dev/gpiochip4");
  ASSERT_EQ(options.out.size(), 3U);
  EXPECT_EQ(options.out[2].signal, Signal::kPrintMark);
  EXPECT_NE(run::prepareJob(test_case).dialog, nullptr);
}

TEST_F(GpioChoiceTest, OutputsThatMakeNoSenseAreFaultsWithFileAndLine) {
  const std::string faults = faultsIn(std::string(kWires) +
                                      "  outputs:\n"
                                      "    encoder_a: 1\n"
                                      "    encoder_b: 1\n"
                                      "    laser_gate: 2\n"
                                      "    power_monitor: 3\n");
  EXPECT_THAT(faults,
              AllOf(HasSubstr("s.yaml:16: firmware.outputs.encoder_b: has line 1, and so has encoder_a"),
                    HasSubstr("s.yaml:17: firmware.outputs.laser_gate: is an output of the controller"),
                    HasSubstr("s.yaml:18: firmware.outputs.power_monitor: cannot be driven")));
  EXPECT_THAT(faultsIn(std::string(kWires) + "  out_chip: gpiochip0\n  max_lag_us: 3\n"),
              AllOf(HasSubstr("s.yaml:14: firmware.out_chip: belongs to firmware.outputs"),
                    HasSubstr("s.yaml:15: firmware.max_lag_us: belongs to firmware.outputs")));
  EXPECT_THAT(faultsIn(std::string(kWires) + "  outputs: {power: 3}\n"), HasSubstr("unknown key"));
}

TEST_F(GpioChoiceTest, ALineCannotBeReadAndDriven) {
  GpioChoice choice = plate(std::string(kWires) + kOutputs).scenario.firmware.gpio;
  EXPECT_EQ(liveOptions(choice, chips()).out.size(), 3U);
  choice.outputs[1].line = "5";
  choice.outputs[2].line = "77";
  try {
    (void)liveOptions(choice, chips());
    FAIL();
  } catch (const source::GpioError& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("firmware.outputs.encoder_b: is line 5, and so is galvo_x_dir"),
                                HasSubstr("firmware.outputs.print_mark: /dev/gpiochip3 has no line 77")));
  }
  choice.out_chip = "gpiochip9";
  EXPECT_THROW((void)liveOptions(choice, chips()), source::GpioError);
}

TEST_F(GpioChoiceTest, ProvokedFaultsNeedTheReferenceController) {
  EXPECT_THAT(faultsIn(std::string(kWires) + "provoke: {line_cut_at_s: 1}\n"), HasSubstr("provoke"));
  EXPECT_THAT(faultsIn(std::string(kWires) +
                       "  uart: /dev/ttyUSB0\n  dialog: kerfbench\nprovoke: {interlock_open_at_s: 1}\n"),
              HasSubstr("provoke: is for emulated releases"));
}

TEST_F(GpioChoiceTest, OnlyRunOpensRealPins) {
  EXPECT_THROW((void)run::openRelease(plate(kWires).scenario.firmware, temp_.path()), base::InputError);
}

TEST_F(GpioChoiceTest, AllLinesThatTheChipDoesNotHaveAreTold) {
  GpioChoice choice = plate(kWires).scenario.firmware.gpio;
  choice.lines[0].line = "12";
  choice.lines[1].line = "ENA";
  choice.lines[2].line = "7";
  try {
    (void)captureOptions(choice, chips());
    FAIL();
  } catch (const source::GpioError& e) {
    EXPECT_THAT(e.what(),
                AllOf(HasSubstr("s.yaml:8: firmware.lines.galvo_x_pul: /dev/gpiochip3 has no line 12"),
                      HasSubstr("s.yaml:9: firmware.lines.galvo_x_dir: /dev/gpiochip3 has no line of the "
                                "name 'ENA'"),
                      HasSubstr("s.yaml:11: firmware.lines.galvo_y_dir: is line 7, and so is galvo_y_pul")));
  }
  EXPECT_THROW((void)captureOptions(choice, {}), source::GpioError);
}

}  // namespace
}  // namespace kerfbench::scenario
