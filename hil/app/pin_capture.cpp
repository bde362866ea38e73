// SPDX-License-Identifier: Apache-2.0
#include "hil/app/pin_capture.h"

#include <fmt/format.h>

#include "hil/app/gpio_choice.h"
#include "hil/app/release.h"

namespace kerfbench::hil {

std::array<std::pair<Signal, const twin::AxisDescription*>, 5> pulAxes(
    const twin::MachineDescription& machine) {
  return {{{Signal::kGalvoXPul, &machine.galvo_x},
           {Signal::kGalvoYPul, &machine.galvo_y},
           {Signal::kGantryXPul, &machine.gantry_x},
           {Signal::kGantryYPul, &machine.gantry_y},
           {Signal::kFeedPul, &machine.belt.feed}}};
}

std::vector<Signal> countedRising(const twin::MachineDescription& machine) {
  std::vector<Signal> rising;
  for (const auto& [signal, axis] : pulAxes(machine)) {
    if (axis->profile.active_edge_rising) rising.push_back(signal);
  }
  return rising;
}

void tellCapture(const PinCapture& captured, Console& console) {
  for (const std::string& note : captured.notes) console.say("  " + note);
  console.say(fmt::format("  {} edges in {:.3f} s", captured.edges,
                          captured.recording.rate.seconds(captured.recording.end)));
}

PinCapture captureCase(const Case& the_case, const std::shared_ptr<GpioSystem>& system,
                       const GpioChipList& chips, Console& console) {
  try {
    GpioCaptureOptions options = captureOptions(the_case.scenario.firmware.gpio, chips);
    options.time_limit_s = the_case.scenario.time_limit_s;
    options.low_at_start = countedRising(the_case.machine);
    console.say(
        fmt::format("  listening to {} lines of {}: start the job; it is over when they are quiet for {} s",
                    options.wires.size(), options.chip.string(), options.quiet_s));
    PinCapture captured = capturePins(options, the_case.machine.signals, system);
    tellCapture(captured, console);
    return captured;
  } catch (const GpioError& e) {
    throw InputFault(e.what());
  }
}

}  // namespace kerfbench::hil
