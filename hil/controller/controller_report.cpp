// SPDX-License-Identifier: Apache-2.0
#include "hil/controller/controller_report.h"

#include <algorithm>

#include <fmt/format.h>

#include "firmware_under_test/controller/protocol.h"
#include "firmware_under_test/planner/program/link.h"

namespace kerfbench::controller {
namespace {

using Said = inspect::ControllerEnd::Said;

bool guardOpened(const source::PinRecording& recording, double until_s) {
  return std::ranges::any_of(recording.sensors.streamed(), [&](const SensorEdge& edge) {
    return edge.signal == Signal::kInterlock && !edge.level && recording.rate.seconds(edge.tick) <= until_s;
  });
}

bool isOfRelease(const UartListener::End& end, const source::PinRecording& recording) {
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

inspect::ControllerEnd controllerEnd(const UartListener& ear, const PulseCounter& pins,
                                     const source::PinRecording& recording) {
  inspect::ControllerEnd end{.last_pulse_s = pins.lastPulse_s()};
  if (!ear.end()) return end;
  end.time_s = ear.end()->time_s;
  end.said = ear.end()->done ? Said::kDone : Said::kStopped;
  if (end.said == Said::kDone) return end;
  end.fault = faultName(ear.end()->fault);
  end.reason = planner::faultInWords(ear.end()->fault);
  end.of_release = isOfRelease(*ear.end(), recording);
  return end;
}

std::string unprovenEnd(const inspect::ControllerEnd& end, const DialogFailure& dialog, bool is_sound) {
  const bool gave_up = !dialog.reason.empty() && dialog.time_s < end.time_s;
  if (end.said == Said::kStopped && !gave_up) {
    if (end.of_release) return {};
    return fmt::format("at {:.3f} s: the controller stopped: {}", end.time_s, end.reason);
  }
  if (end.said == Said::kNothing && dialog.reason.empty() && is_sound)
    return "The controller never said that it has done the job.";
  return dialog.reason;
}

}  // namespace kerfbench::controller
