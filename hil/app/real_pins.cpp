// SPDX-License-Identifier: Apache-2.0
#include "hil/app/real_pins.h"

#include "hil/app/analyser_capture.h"
#include "hil/app/pin_capture.h"
#include "hil/app/release.h"

namespace kerfbench::hil {

RealPins realPins(const std::filesystem::path& bin_dir) {
  return {.gpio = linuxGpioSystem(),
          .chips = [] { return listChips(); },
          .serial = linuxSerialSystem(),
          .analysers = sigrokAnalysers(bin_dir)};
}

std::string pinsName(const FirmwareChoice& firmware) {
  if (firmware.source == FirmwareChoice::Source::kGpio) return "gpiochip " + firmware.gpio.chip;
  const AnalyserChoice& analyser = firmware.analyser;
  return "analyser " + analyser.driver + (analyser.conn.empty() ? "" : " at " + analyser.conn) +
         (analyser.serial.empty() ? "" : ", serial " + analyser.serial);
}

PinCapture hearPins(const Case& the_case, const RealPins& pins, Console& console) {
  const FirmwareChoice& firmware = the_case.scenario.firmware;
  if (firmware.source == FirmwareChoice::Source::kGpio && firmware.gpio.isLive()) {
    throw InputFault(
        firmware.gpio.place +
        ": firmware.outputs and firmware.uart need the model beside the pins: `run` drives them, "
        "and records what came in pins.vcd; `capture` listens only");
  }
  if (firmware.source == FirmwareChoice::Source::kGpio)
    return captureCase(the_case, pins.gpio, pins.chips(), console);
  return captureAnalyserCase(the_case, *pins.analysers, console);
}

}  // namespace kerfbench::hil
