// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/controller_evidence.h"

#include <algorithm>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hil/base/file_content.h"
#include "hil/controller/pulse_counter.h"
#include "hil/controller/status_report.h"
#include "hil/controller/uart_listener.h"
#include "hil/judge/safe_demand.h"
#include "hil/scenario/pul_axes.h"

namespace kerfbench::judge {
namespace {

/// A controller that nothing reaches any more cannot answer the last question.
bool canBeAsked(const scenario::ProvokeChoice& provoke) {
  return provoke.cause != scenario::ProvokeChoice::Cause::kUartSilent &&
         provoke.cause != scenario::ProvokeChoice::Cause::kUartNoise;
}

/// A line that is emulated loses nothing, so words that are broken were broken since, or by the release.
/// Empty for whole ones, and for a real line.
std::string strayWords(const scenario::FirmwareChoice& firmware, const controller::UartListener& ear) {
  if (firmware.onRealPins() || ear.strayBytes() == 0) return {};
  return fmt::format(
      "{} bytes of what the controller said belong to no whole report: words are missing or changed",
      ear.strayBytes());
}

controller::PulseCounter pulsesOf(const scenario::Case& test_case, const source::PinRecording& recording) {
  std::vector<controller::DriveOfPul> drives;
  for (const auto& [pul, axis] : scenario::pulAxes(test_case.machine))
    drives.emplace_back(pul, axis->profile);
  return {recording, test_case.machine.signals, drives};
}

/// Whether a line sends Grbl home: its places count from there then.
bool goesHome(std::string line) {
  std::erase_if(line, [](char c) { return c == ' ' || c == '\t'; });
  return line.starts_with("$H") || line.starts_with("$h");
}

bool goesHome(const scenario::FirmwareChoice& firmware) {
  if (std::ranges::any_of(firmware.setup, [](const std::string& line) { return goesHome(line); }))
    return true;
  std::istringstream gcode(base::fileContent(firmware.gcode).value_or(""));
  for (std::string line; std::getline(gcode, line);)
    if (goesHome(line)) return true;
  return false;
}

/// Where a firmware that is asked by `?` says that it is, beside its pulses. Nothing where these need not
/// agree: it does not say so at rest, moves mirrors, which have no mm, may have woken elsewhere (none of the
/// bench's emulators runs it), has homed, or moved before it was sent a line.
std::optional<inspect::ControllerAccount> accountOfReport(const scenario::Case& test_case,
                                                          const source::PinRecording& recording) {
  const twin::MachineDescription& machine = test_case.machine;
  if (machine.kind != twin::MachineDescription::Kind::kGantry) return std::nullopt;
  const scenario::FirmwareChoice& firmware = test_case.scenario.firmware;
  const controller::StatusWords words = controller::statusWords(recording);
  if (firmware.emulator() == nullptr || !words.last || !words.first_ok || goesHome(firmware))
    return std::nullopt;
  const controller::PulseCounter pins = pulsesOf(test_case, recording);
  const double answered_s = recording.rate.seconds(*words.first_ok);
  for (const Signal pul : {Signal::kGantryXPul, Signal::kGantryYPul})
    if (pins.pulse_s(pul, 1) < answered_s) return std::nullopt;
  const bool at_rest = recording.rate.seconds(words.last->heard) >= pins.lastPulse_s();
  if (words.last->state != "Idle" || !at_rest) return std::nullopt;
  return controller::compareWithStatus(
      *words.last, pins,
      {{{Signal::kGantryXPul, machine.gantry_x.step}, {Signal::kGantryYPul, machine.gantry_y.step}}});
}

/// Adds the problem to run and recording, unless it is there: a replay has it already.
void addProblem(const std::string& problem, run::RecordedRun& run) {
  if (problem.empty()) return;
  for (std::vector<std::string>* problems : {&run.problems, &run.recording.problems}) {
    if (std::ranges::find(*problems, problem) == problems->end()) problems->push_back(problem);
  }
}

}  // namespace

std::string unprovenDialog(const scenario::Case& test_case, const source::PinRecording& recording,
                           const run::RecordedRun& run) {
  if (test_case.scenario.firmware.dialog != scenario::FirmwareChoice::Dialog::kKerfbench)
    return run.dialog.reason;
  const controller::PulseCounter pins = pulsesOf(test_case, recording);
  return controller::unprovenEnd(
      controller::controllerEnd(controller::UartListener(recording), pins, recording), run.dialog,
      run.problems.empty());
}

void collectControllerEvidence(const scenario::Case& test_case, const run::PreparedJob& job,
                               const source::PinRecording& recording, double line_cut_s,
                               run::RecordedRun& run, Conclusion& conclusion) {
  const scenario::FirmwareChoice& firmware = test_case.scenario.firmware;
  if (firmware.dialog != scenario::FirmwareChoice::Dialog::kKerfbench) {
    addProblem(run.dialog.reason, run);
    if (firmware.dialog == scenario::FirmwareChoice::Dialog::kLineOk)
      conclusion.words.account = accountOfReport(test_case, recording);
    return;
  }
  const controller::PulseCounter pins = pulsesOf(test_case, recording);
  const controller::UartListener ear(recording);
  conclusion.words.account = pins.compareWithReport(
      ear.account(),
      {static_cast<double>(firmware.baud), firmware.gpio.uart.empty() ? 0.0 : firmware.gpio.uart_delay_s});
  const scenario::ProvokeChoice& provoke = test_case.scenario.provoke;
  if (provoke.cause == scenario::ProvokeChoice::Cause::kNone) {
    addProblem(strayWords(firmware, ear), run);
    conclusion.words.end = controller::controllerEnd(ear, pins, recording);
    addProblem(controller::unprovenEnd(*conclusion.words.end, run.dialog, run.problems.empty()), run);
    return;
  }
  inspect::SafeStateEvidence evidence;
  evidence.demand = safeStateDemand(test_case, job, pins, line_cut_s);
  evidence.last_pulse_s = pins.lastPulse_s();
  evidence.end_s = recording.rate.seconds(recording.end);
  evidence.reports = ear.reports();
  if (canBeAsked(provoke)) evidence.account = conclusion.words.account;
  evidence.problems = run.problems;
  conclusion.safe_state = std::move(evidence);
}

}  // namespace kerfbench::judge
