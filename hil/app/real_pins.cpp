// SPDX-License-Identifier: Apache-2.0
#include "hil/app/real_pins.h"

#include "hil/app/pin_capture.h"

namespace kerfbench::hil {

RealPins realPins() {
  return {.gpio = linuxGpioSystem(), .chips = [] { return listChips(); }};
}

std::string pinsName(const FirmwareChoice& firmware) { return "gpiochip " + firmware.gpio.chip; }

PinCapture hearPins(const Case& the_case, const RealPins& pins, Console& console) {
  return captureCase(the_case, pins.gpio, pins.chips(), console);
}

}  // namespace kerfbench::hil
