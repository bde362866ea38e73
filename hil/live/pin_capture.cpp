// SPDX-License-Identifier: Apache-2.0
#include "hil/live/pin_capture.h"

#include <fmt/format.h>

#include "hil/live/pin_watch.h"
#include "hil/run/release.h"
#include "hil/scenario/gpio_choice.h"
#include "hil/scenario/pul_axes.h"

namespace kerfbench::live {

void tellCapture(const source::PinCapture& captured, base::Console& console) {
  for (const std::string& note : captured.notes) console.say("  " + note);
  console.say(fmt::format("  {} edges in {:.3f} s", captured.edges,
                          captured.recording.rate.seconds(captured.recording.end)));
}

source::PinCapture captureCase(const scenario::Case& test_case,
                               const std::shared_ptr<source::GpioSystem>& system,
                               const source::GpioChipList& chips, base::Console& console) {
  try {
    source::GpioCaptureOptions options = scenario::captureOptions(test_case.scenario.firmware.gpio, chips);
    options.time_limit_s = test_case.scenario.time_limit_s;
    options.at_start = scenario::startLevels(test_case.machine);
    console.say(
        fmt::format("  listening to {} lines of {}: start the job; it is over when they are quiet for {} s",
                    options.wires.size(), options.chip.string(), options.quiet_s));
    PinWatch watch(test_case.machine.signals, source::kNanoseconds, console.events());
    if (watch.isWatched())
      options.heard = [&watch, wires = options.wires](std::uint64_t now_ns,
                                                      std::span<const source::LineEdge> edges) {
        watch.heard(now_ns, edges, wires);
      };
    console.event("operator", {{"text", "Start the job at the machine."}});
    source::PinCapture captured = source::capturePins(options, test_case.machine.signals, system);
    tellCapture(captured, console);
    return captured;
  } catch (const source::GpioError& e) {
    throw base::InputError(e.what());
  }
}

}  // namespace kerfbench::live
