// SPDX-License-Identifier: Apache-2.0
#include "hil/app/analyser_capture.h"

#include <fmt/format.h>

#include "hil/app/pin_capture.h"
#include "hil/app/release.h"

namespace kerfbench::hil {

PinCapture captureAnalyserCase(const Case& the_case, AnalyserSystem& analysers, Console& console) {
  const AnalyserChoice& choice = the_case.scenario.firmware.analyser;
  AnalyserCaptureOptions options = captureOptions(choice);
  options.time_limit_s = the_case.scenario.time_limit_s;
  options.low_at_start = countedRising(the_case.machine);
  console.say(fmt::format(
      "  listening to {} channels by {} at {} Hz: start the job; it is over when they are quiet for {} s",
      options.signals.size(), choice.driver, choice.samplerate_hz, options.quiet_s));
  try {
    PinCapture captured = captureAnalyser(options, the_case.machine.signals, analysers);
    tellCapture(captured, console);
    return captured;
  } catch (const AnalyserError& e) {
    throw InputFault(choice.place + ": " + e.what());
  }
}

}  // namespace kerfbench::hil
