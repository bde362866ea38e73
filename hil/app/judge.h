// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/app/case.h"
#include "hil/app/lockstep.h"
#include "hil/app/stopwatch.h"
#include "hil/report/run_report.h"
#include "twin/cutter/twin.h"

namespace kerfbench::hil {

/// What the cameras of the bench see of a run that the twin has lived through, measured and judged. Fills the
/// measured part of `report` (limits, dieline, print, kerf, spot, pulses, result).
void judge(const Case& the_case, twin::Twin& twin, const LockstepResult& run, int jobs,
           Stopwatch& stopwatch, const ProgressFn& progress, RunReport& report);

}  // namespace kerfbench::hil
