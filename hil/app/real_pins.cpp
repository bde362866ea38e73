// SPDX-License-Identifier: Apache-2.0
#include "hil/app/real_pins.h"

#include "hil/app/analyser_capture.h"
#include "hil/app/pin_capture.h"

namespace kerfbench::hil {

RealPins realPins(const std::filesystem::path& bin_dir) {
  return {
      .gpio = linuxGpioSystem(), .chips = [] { return listChips(); }, .analysers = sigrokAnalysers(bin_dir)};
}

std::string pinsName(const FirmwareChoice& firmware) {
  if (firmware.source == FirmwareChoice::Source::kGpio) return "gpiochip " + firmware.gpio.chip;
  const AnalyserChoice& analyser = firmware.analyser;
  return "analyser " + analyser.driver + (analyser.conn.empty() ? "" : " at " + analyser.conn) +
         (analyser.serial.empty() ? "" : ", serial " + analyser.serial);
}

PinCapture hearPins(const Case& the_case, const RealPins& pins, Console& console) {
  if (the_case.scenario.firmware.source == FirmwareChoice::Source::kGpio)
    return captureCase(the_case, pins.gpio, pins.chips(), console);
  return captureAnalyserCase(the_case, *pins.analysers, console);
}

}  // namespace kerfbench::hil
