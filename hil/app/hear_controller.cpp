// SPDX-License-Identifier: Apache-2.0
#include "hil/app/hear_controller.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "hil/app/controller_ear.h"
#include "hil/app/pin_sums.h"
#include "hil/app/safe_demand.h"

namespace kerfbench::hil {
namespace {

/// A controller that nothing reaches any more cannot answer the last question.
bool canBeAsked(const ProvokeChoice& provoke) {
  return provoke.cause != ProvokeChoice::Cause::kUartSilent &&
         provoke.cause != ProvokeChoice::Cause::kUartNoise;
}

/// To both that do not have it: a recording says so already in its replay.
void addProblem(const std::string& problem, LockstepResult& run) {
  if (problem.empty()) return;
  for (std::vector<std::string>* problems : {&run.problems, &run.recording.problems}) {
    if (std::ranges::find(*problems, problem) == problems->end()) problems->push_back(problem);
  }
}

}  // namespace

std::string unprovenDialog(const Case& the_case, const PinRecording& recording, const LockstepResult& run) {
  if (the_case.scenario.firmware.dialog != FirmwareChoice::Dialog::kKerfbench) return run.dialog_failure;
  const PinSums pins(recording, the_case.machine.signals);
  return unprovenEnd(controllerEnd(ControllerEar(recording), pins, recording), run);
}

void hearController(const Case& the_case, const PreparedJob& job, const PinRecording& recording,
                    double line_cut_s, LockstepResult& run, Conclusion& conclusion) {
  const FirmwareChoice& firmware = the_case.scenario.firmware;
  if (firmware.dialog != FirmwareChoice::Dialog::kKerfbench) {
    addProblem(run.dialog_failure, run);
    return;
  }
  const PinSums pins(recording, the_case.machine.signals);
  const ControllerEar ear(recording);
  conclusion.words.account = pins.accountBeside(
      ear.account(),
      {static_cast<double>(firmware.baud), firmware.gpio.uart.empty() ? 0.0 : firmware.gpio.uart_delay_s});
  const ProvokeChoice& provoke = the_case.scenario.provoke;
  if (provoke.cause == ProvokeChoice::Cause::kNone) {
    conclusion.words.end = controllerEnd(ear, pins, recording);
    addProblem(unprovenEnd(*conclusion.words.end, run), run);
    return;
  }
  SafeStateEvidence evidence;
  evidence.demand = safeStateDemand(the_case, job, pins, line_cut_s);
  evidence.last_pulse_s = pins.lastPulse_s();
  evidence.end_s = recording.rate.seconds(recording.end);
  evidence.reports = ear.reports();
  if (canBeAsked(provoke)) evidence.account = conclusion.words.account;
  evidence.problems = run.problems;
  conclusion.safe_state = std::move(evidence);
}

}  // namespace kerfbench::hil
