// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/controller/pulse_counter.h"
#include "hil/inspect/safe_state.h"
#include "hil/run/dialogs.h"
#include "hil/scenario/case.h"
#include "hil/scenario/provoke_choice.h"

namespace kerfbench::judge {

/// What the run must show after what the scenario provoked: the windows of docs/reference/controller.md,
/// written here once more and apart from the firmware's own constants. `line_cut_s` as
/// Provocation::lineCut_s().
inspect::SafeStateDemand safeStateDemand(const scenario::Case& test_case, const run::PreparedJob& job,
                                         const controller::PulseCounter& pins, double line_cut_s);

}  // namespace kerfbench::judge
