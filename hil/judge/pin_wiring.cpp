// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/pin_wiring.h"

namespace kerfbench::judge {

evidence::PinWiring pinWiring(const scenario::Case& test_case) {
  const twin::MachineDescription& machine = test_case.machine;
  evidence::PinWiring wiring;
  wiring.signals = machine.signals;
  wiring.gate_low = machine.laser.gate_low;
  wiring.pwm_low = machine.laser.pwm_low;
  wiring.encoder_count_mm = machine.controller.encoder_count_mm;
  wiring.power_meter_delay_s = machine.power_monitor.delay_s;
  if (machine.kind == twin::MachineDescription::Kind::kGantry) {
    wiring.drives.push_back({"gantry_x", Signal::kGantryXPul, Signal::kGantryXDir, machine.gantry_x.profile});
    wiring.drives.push_back({"gantry_y", Signal::kGantryYPul, Signal::kGantryYDir, machine.gantry_y.profile});
  } else {
    wiring.drives.push_back({"galvo_x", Signal::kGalvoXPul, Signal::kGalvoXDir, machine.galvo_x.profile});
    wiring.drives.push_back({"galvo_y", Signal::kGalvoYPul, Signal::kGalvoYDir, machine.galvo_y.profile});
  }
  if (scenario::webOf(test_case).fed_by_controller)
    wiring.drives.push_back({"feed", Signal::kFeedPul, Signal::kFeedDir, machine.belt.feed.profile});
  return wiring;
}

}  // namespace kerfbench::judge
