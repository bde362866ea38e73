// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hil/diagnose/evidence.h"
#include "hil/judge/asked_path.h"
#include "hil/judge/timed_cuts.h"

namespace kerfbench::judge {

/// What a scenario orders of the laser, and how its head speeds up.
struct CutOrder {
  double full_power_w{};
  double energy_j_mm{};  ///< For each mm of a cut; 0: not ordered that way.
  double speed_mm_s{};
  double acceleration_mm_s2{};
};

/// Gate and light of each cut against the way that the pulses led the beam over the sheet.
std::vector<diagnose::GateReading> gateReadings(const TimedCuts& cuts, const AskedPath& asked,
                                                const SheetPath& sheet,
                                                const std::vector<inspect::Span>& light,
                                                const CutOrder& order);

/// Light and speed within each cut, of which powerSwing() tells whether the power swings.
std::vector<diagnose::PowerRun> powerRuns(const TimedCuts& cuts, const std::vector<inspect::Span>& light);

}  // namespace kerfbench::judge
