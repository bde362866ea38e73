// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hil/inspect/inspect.h"
#include "hil/inspect/verdict/controller_account.h"
#include "hil/inspect/verdict/controller_state.h"
#include "hil/inspect/verdict/tolerances.h"

namespace kerfbench::inspect {

/// What a provoked run must show. All times in s on the clock of the pins.
struct SafeStateDemand {
  std::string cause;  ///< For people: "the guard was opened".
  double cause_s{};   ///< NaN: it never came about.
  double window_s{};  ///< Until the cause can be known: 0 where a pin tells, else as the controller states.
  double stop_s{};    ///< Axes at rest after the laser had to be off.
  double report_s{};  ///< The reason told after the laser had to be off.
  std::vector<std::string> faults;  ///< Names of the reasons, any of which is right.
};

/// Pins and UART, never the model.
struct SafeStateEvidence {
  SafeStateDemand demand;
  std::vector<GateInterval> gates;  ///< In order of time.
  double last_pulse_s{};            ///< Time of the last pulse of any axis; < 0: none.
  double end_s{};                   ///< End of the recording.
  std::vector<ControllerState> reports;
  std::vector<PulseTiming> pulses;
  /// None: the controller could not be asked, because the line to it is dead.
  std::optional<ControllerAccount> account;
  double pin_u_s{};
  std::vector<std::string> problems;
};

/// Where the cause can only be inferred: the laser must have been on this shortly before it, and the
/// controller may have noticed so much earlier.
inline constexpr double kInferredEarly_s = 0.02;

/// Judges a run that was to be stopped: checks `safe_state` (the laser's gate off in time, and for good),
/// `safe_stop` (no pulse after the axes had to stand), `safe_report`, `account`, `pulse_timing`. Path and all
/// that cameras see are not judged: the job is not done. INVALID where the cause never came about, or where
/// the laser was dark anyway.
InspectionResult inspectSafeState(const SafeStateEvidence& evidence);

}  // namespace kerfbench::inspect
