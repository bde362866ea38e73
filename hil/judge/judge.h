// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "hil/base/stopwatch.h"
#include "hil/controller/controller_report.h"
#include "hil/inspect/safe_state.h"
#include "hil/report/run_report.h"
#include "hil/run/lockstep.h"
#include "hil/scenario/case.h"
#include "twin/cutter/twin.h"

namespace kerfbench::judge {

/// Recordings of real cameras of this run.
struct RealPictures {
  std::filesystem::path spot;  ///< Folder of the spot camera's frames; empty: the twin's camera looks.
};

/// What the cameras of the bench see of a run that the twin has lived through, measured and judged. Fills the
/// measured part of `report` (limits, dieline, print, kerf, spot, pulses, result).
void judge(const scenario::Case& test_case, twin::Twin& twin, const run::LockstepResult& run,
           const controller::ControllerReport& words, const RealPictures& pictures, int jobs,
           base::Stopwatch& stopwatch, const run::ProgressFn& progress, report::RunReport& report);

/// A run that was to be stopped, by its pins and the controller's words alone; no camera looks.
void judgeSafeState(const scenario::Case& test_case, const twin::Twin& twin,
                    inspect::SafeStateEvidence evidence, report::RunReport& report);

}  // namespace kerfbench::judge
