// SPDX-License-Identifier: Apache-2.0
#include "hil/live/real_pins.h"

#include "hil/live/analyser_capture.h"
#include "hil/live/pin_capture.h"
#include "hil/run/release.h"

namespace kerfbench::live {

RealPins realPins(const std::filesystem::path& bin_dir) {
  return {.gpio = source::linuxGpioSystem(),
          .chips = [] { return source::listChips(); },
          .serial = source::linuxSerialSystem(),
          .analysers = source::sigrokAnalysers(bin_dir)};
}

std::string pinsName(const scenario::FirmwareChoice& firmware) {
  if (firmware.source == scenario::FirmwareChoice::Source::kGpio) return "gpiochip " + firmware.gpio.chip;
  const scenario::AnalyserChoice& analyser = firmware.analyser;
  return "analyser " + analyser.driver + (analyser.conn.empty() ? "" : " at " + analyser.conn) +
         (analyser.serial.empty() ? "" : ", serial " + analyser.serial);
}

source::PinCapture hearPins(const scenario::Case& test_case, const RealPins& pins, base::Console& console) {
  const scenario::FirmwareChoice& firmware = test_case.scenario.firmware;
  if (firmware.source == scenario::FirmwareChoice::Source::kGpio && firmware.gpio.isLive()) {
    throw base::InputError(
        firmware.gpio.place +
        ": firmware.outputs and firmware.uart need the model beside the pins: `run` drives them, "
        "and records what came in pins.vcd; `capture` listens only");
  }
  if (firmware.source == scenario::FirmwareChoice::Source::kGpio)
    return captureCase(test_case, pins.gpio, pins.chips(), console);
  return captureAnalyserCase(test_case, *pins.analysers, console);
}

}  // namespace kerfbench::live
