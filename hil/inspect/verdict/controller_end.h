// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/inspect/verdict/verdict.h"

namespace kerfbench::inspect {

struct GateInterval;

/// How the controller says that a run ended in which nothing was to go wrong.
struct ControllerEnd {
  enum class Said { kNothing, kDone, kStopped };
  Said said{Said::kNothing};
  double time_s{};          ///< When it was heard.
  std::string fault{};      ///< Name of what it stopped for.
  std::string reason{};     ///< The same in words: "the belt is too fast for this job".
  bool of_release{};        ///< The release or its settings have to answer for that.
  double last_pulse_s{-1};  ///< Time of the last pulse of any axis, by the pins; < 0: none.
};

/// What the release proved by stopping: its own words, beside pins that are at rest from then on.
bool stoppedByItself(const ControllerEnd& end, const std::vector<GateInterval>& gates);

namespace checks {
/// "finish": FAIL if stoppedByItself(), PASS if it says that it is done. INVALID if it said neither, if what
/// it stopped for is no matter of the release (line, host, guard), or if its pins contradict its words.
Check finishCheck(const ControllerEnd& end, const std::vector<GateInterval>& gates);
}  // namespace checks

}  // namespace kerfbench::inspect
