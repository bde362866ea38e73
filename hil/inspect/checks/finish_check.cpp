// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "hil/inspect/checks/checks.h"
#include "hil/inspect/evidence/whereabouts.h"

namespace kerfbench::inspect {
namespace {

using Said = ControllerEnd::Said;

double lastLight_s(const std::vector<GateInterval>& gates) {
  double last_s = -1.0;
  for (const GateInterval& gate : gates) last_s = std::max(last_s, gate.off_s);
  return last_s;
}

// The controller reports its end when laser and axes are at rest.
bool atRest(const ControllerEnd& end, const std::vector<GateInterval>& gates) {
  return lastLight_s(gates) <= end.time_s && end.last_pulse_s <= end.time_s;
}

std::string explanationOf(const ControllerEnd& end, const std::vector<GateInterval>& gates) {
  if (end.said == Said::kNothing) return "The controller never said that it has done the job.";
  const std::string words =
      end.said == Said::kDone
          ? fmt::format("At {:.3f} s the controller said that it has done the job", end.time_s)
          : fmt::format("At {:.3f} s the controller stopped before the job was done: {}", end.time_s,
                        end.reason);
  const double light_s = lastLight_s(gates);
  if (!atRest(end, gates)) {
    return fmt::format("{}; but its pins went on until {:.3f} s, so its words prove nothing.", words,
                       std::max(light_s, end.last_pulse_s));
  }
  if (end.said == Said::kDone) return words + ".";
  return fmt::format(
      "{}. {}{}", words,
      light_s < 0.0 ? "Its laser was never on" : fmt::format("Its laser was last on at {:.3f} s", light_s),
      end.of_release ? "." : "; that proves nothing of the release.");
}

}  // namespace

bool stoppedByItself(const ControllerEnd& end, const std::vector<GateInterval>& gates) {
  return end.said == Said::kStopped && end.of_release && atRest(end, gates);
}

namespace checks {

namespace {

Check finishHead() { return {.name = "finish", .title = "The controller finishes the job", .unit = "stops"}; }

}  // namespace

Unjudged absentReport(const Evidence& evidence, const Check& check) {
  return {check.name, check.title, evidence.words_expected, evidence.no_words};
}

Finding finishFinding(const Evidence& evidence) {
  if (evidence.end) return finishCheck(*evidence.end, evidence.gates);
  return absentReport(evidence, finishHead());
}

Check finishCheck(const ControllerEnd& end, const std::vector<GateInterval>& gates) {
  Check check = finishHead();
  check.limit = 0.0;
  check.value = std::numeric_limits<double>::quiet_NaN();
  if (stoppedByItself(end, gates)) {
    check.value = 1.0;
  } else if (end.said == Said::kDone && atRest(end, gates)) {
    check.value = 0.0;
  }
  check.subject = end.fault;
  if (end.said != Said::kNothing) check.where = atTime(end.time_s);
  check.explanation = explanationOf(end, gates);
  decide(check);
  return check;
}

}  // namespace checks
}  // namespace kerfbench::inspect
