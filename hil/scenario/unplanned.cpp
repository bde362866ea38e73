// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/unplanned.h"

namespace kerfbench::scenario {

std::optional<std::string> whyNothingIsPlanned(const Scenario& scenario) {
  using Dialog = FirmwareChoice::Dialog;
  if (scenario.firmware.dialog == Dialog::kLineOk)
    return "is line-ok: the firmware plans its own motion from firmware.gcode, and the bench plans none";
  if (scenario.firmware.dialog == Dialog::kNone)
    return "is none: the job is in the controller, and the bench plans none";
  return std::nullopt;
}

}  // namespace kerfbench::scenario
