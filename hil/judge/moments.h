// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/inspect/safe_state.h"
#include "hil/report/run_report.h"
#include "hil/source/vcd.h"
#include "twin/base/signal_map.h"

namespace kerfbench::judge {

/// So long before and after the time of a check the pins are shown.
inline constexpr double kMomentAround_s = 5e-3;

/// Adds to a report which lines of the program the spot was seen on, and the pins around the times of checks
/// that did not pass. For people: it reads what was judged, and judges nothing.
/// @param gcode The program of one unit; empty: not known.
void addMoments(const source::PinRecording& recording, const SignalMap& signals, const std::string& gcode,
                report::RunReport& report);

/// The time line of a run that was to be stopped. `evidence` with pulses and gates.
report::SafeTimeline safeTimeline(const inspect::SafeStateEvidence& evidence);

}  // namespace kerfbench::judge
