// SPDX-License-Identifier: Apache-2.0
#include "hil/source/pin_capture.h"

#include <fmt/format.h>

#include <algorithm>

namespace kerfbench::source {

void spoilEnd(PinRecording& recording, std::uint16_t port) {
  if (recording.problems.empty()) return;
  recording.outputs.push_back({recording.end, port, 0, recording.outputs.levelsOf(port), PinEvent::kGap});
}

std::string wrongAtStartWords(Signal signal, bool level, const StartLevels& wanted) {
  const std::vector<Signal>& others = level ? wanted.low : wanted.high;
  if (std::ranges::find(others, signal) == others.end()) return {};
  return fmt::format("{} is {} at the start, and {}: polarity or wiring is not as the machine file has it",
                     signalName(signal), level ? "high" : "low",
                     level ? "its drive counts rising edges" : "the laser may emit while it is low");
}

std::string timeLimitWords(double time_limit_s, bool any_edge) {
  return any_edge
             ? fmt::format("the time limit of {} s was reached, and the pins were not quiet", time_limit_s)
             : fmt::format("no edge came within {} s: is the controller wired, powered and started?",
                           time_limit_s);
}

}  // namespace kerfbench::source
