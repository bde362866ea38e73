// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/judge/conclude.h"
#include "hil/run/dialogs.h"
#include "hil/run/lockstep.h"
#include "hil/scenario/case.h"
#include "hil/source/vcd.h"

namespace kerfbench::judge {

/// What a dialog that was led leaves unproven of a recording, empty where nothing is: why it failed, unless
/// the reference controller stopped by itself.
std::string unprovenDialog(const scenario::Case& test_case, const source::PinRecording& recording,
                           const run::RecordedRun& run);

/// What the controller itself said of the run, and of its end; what that leaves unproven is a problem, of the
/// recording as well, since a replay has no dialog that could fail.
/// @param line_cut_s when a provocation cut the line to it; NaN: it did not.
void collectControllerEvidence(const scenario::Case& test_case, const run::PreparedJob& job,
                               const source::PinRecording& recording, double line_cut_s,
                               run::RecordedRun& run, Conclusion& conclusion);

}  // namespace kerfbench::judge
