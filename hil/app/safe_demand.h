// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/app/case.h"
#include "hil/app/dialogs.h"
#include "hil/app/pin_sums.h"
#include "hil/app/provoke.h"
#include "hil/inspect/safe_state.h"

namespace kerfbench::hil {

/// What the run must show after what the scenario provoked: the windows of docs/CONTROLLER.md, written here
/// once more and apart from the firmware's own constants. `line_cut_s` as Provocation::lineCut_s().
SafeStateDemand safeStateDemand(const Case& the_case, const PreparedJob& job, const PinSums& pins,
                                double line_cut_s);

}  // namespace kerfbench::hil
