// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "hil/app/case.h"
#include "hil/app/controller_words.h"
#include "hil/app/lockstep.h"
#include "hil/app/stopwatch.h"
#include "hil/inspect/safe_state.h"
#include "hil/report/run_report.h"
#include "twin/cutter/twin.h"

namespace kerfbench::hil {

/// Recordings of real cameras of this run.
struct RealPictures {
  std::filesystem::path spot;  ///< Folder of the spot camera's frames; empty: the twin's camera looks.
};

/// What the cameras of the bench see of a run that the twin has lived through, measured and judged. Fills the
/// measured part of `report` (limits, dieline, print, kerf, spot, pulses, result).
void judge(const Case& the_case, twin::Twin& twin, const LockstepResult& run, const ControllerWords& words,
           const RealPictures& pictures, int jobs, Stopwatch& stopwatch, const ProgressFn& progress,
           RunReport& report);

/// A run that was to be stopped, by its pins and the controller's words alone; no camera looks.
void judgeSafeState(const Case& the_case, const twin::Twin& twin, SafeStateEvidence evidence,
                    RunReport& report);

}  // namespace kerfbench::hil
