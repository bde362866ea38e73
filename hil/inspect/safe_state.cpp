// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/safe_state.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "hil/inspect/checks/checks.h"
#include "hil/inspect/evidence/whereabouts.h"

namespace kerfbench::inspect {
namespace {

std::vector<std::string> problemsOf(const SafeStateEvidence& evidence) {
  std::vector<std::string> problems = evidence.problems;
  const SafeStateDemand& demand = evidence.demand;
  if (!std::isfinite(demand.cause_s)) {
    problems.push_back(fmt::format("Nothing was provoked: never in the run {}.", demand.cause));
    return problems;
  }
  const double before_s = demand.window_s > 0.0 ? kInferredEarly_s : 0.0;
  const bool lit = std::ranges::any_of(evidence.gates, [&](const GateInterval& gate) {
    return gate.on_s < demand.cause_s && gate.off_s >= demand.cause_s - before_s;
  });
  if (!lit) {
    problems.push_back(fmt::format("The laser was dark when {} at {:.6f} s: a dark laser proves nothing.",
                                   demand.cause, demand.cause_s));
  }
  const double needed_s = demand.cause_s + demand.window_s + demand.stop_s + demand.report_s;
  if (evidence.end_s < needed_s) {
    problems.push_back(
        fmt::format("The recording ends at {:.3f} s, before {:.3f} s.", evidence.end_s, needed_s));
  }
  return problems;
}

Check laserCheck(const SafeStateEvidence& evidence) {
  const SafeStateDemand& demand = evidence.demand;
  Check check{.name = "safe_state", .title = "The laser goes off and stays off", .unit = "ms"};
  check.limit = 1e3 * kLaserOff_s;
  check.u = check.guard = 2.0 * std::sqrt(2.0) * 1e3 * evidence.pin_u_s;
  double off_s = 0.0;
  for (const GateInterval& gate : evidence.gates) off_s = std::max(off_s, gate.off_s);
  const double due_s = demand.cause_s + demand.window_s;
  check.where = atTime(demand.cause_s);
  check.value = 1e3 * std::max(off_s - due_s, 0.0);
  decide(check);
  const std::string from = demand.window_s > 0.0
                               ? fmt::format("which may take {:.4g} ms to be known", 1e3 * demand.window_s)
                               : "which a pin tells";
  check.explanation = fmt::format("At {:.6f} s {}, {}; the laser's gate was last on {:.4g} ms {} it.",
                                  demand.cause_s, demand.cause, from, 1e3 * std::abs(off_s - demand.cause_s),
                                  off_s < demand.cause_s ? "before" : "after");
  return check;
}

Check stopCheck(const SafeStateEvidence& evidence) {
  const SafeStateDemand& demand = evidence.demand;
  Check check{.name = "safe_stop", .title = "The axes come to rest and stay there", .unit = "ms"};
  check.limit = 1e3 * (demand.window_s + kLaserOff_s + demand.stop_s);
  check.value = 1e3 * std::max(evidence.last_pulse_s - demand.cause_s, 0.0);
  check.where = atTime(evidence.last_pulse_s > demand.cause_s ? evidence.last_pulse_s : demand.cause_s);
  decide(check);
  check.explanation =
      evidence.last_pulse_s <= demand.cause_s
          ? "No axis made a step after the cause."
          : fmt::format("The last pulse of any axis came {:.4g} ms after the cause.", check.value);
  return check;
}

Check reportCheck(const SafeStateEvidence& evidence) {
  const SafeStateDemand& demand = evidence.demand;
  Check check{.name = "safe_report", .title = "The controller says why it has stopped", .unit = "ms"};
  check.limit = 1e3 * (demand.window_s + kLaserOff_s + demand.stop_s + demand.report_s);
  // Where both infer the cause the controller may be a little before the bench.
  const double early_s = demand.window_s > 0.0 ? kInferredEarly_s : 0.0;
  const auto first = std::ranges::find_if(evidence.reports, [&](const ControllerState& report) {
    return report.stopped && report.time_s >= demand.cause_s - early_s;
  });
  const bool told = first != evidence.reports.end();
  check.where = atTime(told ? first->time_s : demand.cause_s);
  check.value = 1e3 * std::max((told ? first->time_s : evidence.end_s) - demand.cause_s, 0.0);
  decide(check);
  if (!told) {
    check.verdict = Verdict::kFail;
    check.explanation = "The controller never said that it has stopped.";
    return check;
  }
  check.subject = first->fault;
  const bool right = std::ranges::find(demand.faults, first->fault) != demand.faults.end();
  if (!right) check.verdict = Verdict::kFail;
  check.explanation =
      fmt::format("{:.4g} ms after the cause it reported '{}'{}.", check.value, first->fault,
                  right ? "" : fmt::format(" where '{}' is asked for", fmt::join(demand.faults, "' or '")));
  const bool again = std::any_of(first, evidence.reports.end(),
                                 [](const ControllerState& report) { return !report.stopped; });
  if (again) {
    check.verdict = Verdict::kFail;
    check.explanation += " Later it went on by itself.";
  }
  return check;
}

}  // namespace

InspectionResult inspectSafeState(const SafeStateEvidence& evidence) {
  InspectionResult result;
  result.problems = problemsOf(evidence);
  if (std::isfinite(evidence.demand.cause_s)) {
    result.checks.push_back(laserCheck(evidence));
    result.checks.push_back(stopCheck(evidence));
    result.checks.push_back(reportCheck(evidence));
  }
  if (evidence.account) result.checks.push_back(checks::accountCheck(*evidence.account));
  Evidence pins;
  pins.pulses = evidence.pulses;
  pins.pin_u_s = evidence.pin_u_s;
  result.checks.push_back(checks::pulseTimingCheck(pins));
  result.verdict = combine(result.checks, result.problems.empty());
  return result;
}

}  // namespace kerfbench::inspect
