// SPDX-License-Identifier: Apache-2.0
#include "hil/app/controller_words.h"

#include <algorithm>

#include <fmt/format.h>

#include "firmware_under_test/controller/protocol.h"
#include "firmware_under_test/planner/link.h"

namespace kerfbench::hil {
namespace {

using Said = ControllerEnd::Said;

bool guardOpened(const PinRecording& recording, double until_s) {
  return std::ranges::any_of(recording.sensors, [&](const SensorEdge& edge) {
    return edge.signal == Signal::kInterlock && !edge.level && recording.rate.seconds(edge.tick) <= until_s;
  });
}

bool isOfRelease(const ControllerEar::End& end, const PinRecording& recording) {
  switch (end.fault) {
    case KB_OK:  // told to stop
    case KB_FAULT_SILENT:
    case KB_FAULT_UART:
      return false;
    case KB_FAULT_INTERLOCK:
      return !guardOpened(recording, end.time_s);
    default:
      return end.fault < faultNames().size();
  }
}

}  // namespace

ControllerEnd controllerEnd(const ControllerEar& ear, const PinSums& pins, const PinRecording& recording) {
  ControllerEnd end{.last_pulse_s = pins.lastPulse_s()};
  if (!ear.end()) return end;
  end.time_s = ear.end()->time_s;
  end.said = ear.end()->done ? Said::kDone : Said::kStopped;
  if (end.said == Said::kDone) return end;
  end.fault = faultName(ear.end()->fault);
  end.reason = planner::faultInWords(ear.end()->fault);
  end.of_release = isOfRelease(*ear.end(), recording);
  return end;
}

std::string unprovenEnd(const ControllerEnd& end, const LockstepResult& run) {
  const bool gave_up = !run.dialog_failure.empty() && run.dialog_failed_s < end.time_s;
  if (end.said == Said::kStopped && !gave_up) {
    if (end.of_release) return {};
    return fmt::format("at {:.3f} s: the controller stopped: {}", end.time_s, end.reason);
  }
  if (end.said == Said::kNothing && run.dialog_failure.empty() && run.problems.empty())
    return "The controller never said that it has done the job.";
  return run.dialog_failure;
}

}  // namespace kerfbench::hil
