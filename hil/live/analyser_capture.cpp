// SPDX-License-Identifier: Apache-2.0
#include "hil/live/analyser_capture.h"

#include <fmt/format.h>

#include "hil/live/pin_capture.h"
#include "hil/run/release.h"
#include "hil/scenario/pul_axes.h"

namespace kerfbench::live {

source::PinCapture captureAnalyserCase(const scenario::Case& test_case, source::AnalyserSystem& analysers,
                                       base::Console& console) {
  const scenario::AnalyserChoice& choice = test_case.scenario.firmware.analyser;
  source::AnalyserCaptureOptions options = scenario::captureOptions(choice);
  options.time_limit_s = test_case.scenario.time_limit_s;
  options.at_start = scenario::startLevels(test_case.machine);
  console.say(fmt::format(
      "  listening to {} channels by {} at {} Hz: start the job; it is over when they are quiet for {} s",
      options.signals.size(), choice.driver, choice.samplerate_hz, options.quiet_s));
  console.event("operator", {{"text", "Start the job at the machine."}});
  try {
    source::PinCapture captured = source::captureAnalyser(options, test_case.machine.signals, analysers);
    tellCapture(captured, console);
    return captured;
  } catch (const source::AnalyserError& e) {
    throw base::InputError(choice.place + ": " + e.what());
  }
}

}  // namespace kerfbench::live
