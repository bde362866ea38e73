// SPDX-License-Identifier: Apache-2.0
#include "hil/app/hear_controller.h"

#include <string>
#include <utility>

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

void addProblem(const std::string& problem, LockstepResult& run) {
  if (!problem.empty()) run.problems.push_back(problem);
}

}  // namespace

void spoilByDialog(LockstepResult& run) {
  addProblem(run.dialog_failure, run);
  if (!run.dialog_failure.empty()) run.recording.problems.push_back(run.dialog_failure);
}

void hearController(const Case& the_case, const PreparedJob& job, const PinRecording& recording,
                    double line_cut_s, LockstepResult& run, Conclusion& conclusion) {
  if (the_case.scenario.firmware.dialog != FirmwareChoice::Dialog::kKerfbench) {
    spoilByDialog(run);
    return;
  }
  const PinSums pins(recording, the_case.machine.signals);
  const ControllerEar ear(recording);
  conclusion.words.account = pins.accountBeside(ear.account(), the_case.scenario.firmware.baud);
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
