// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/app/case.h"
#include "hil/app/conclude.h"
#include "hil/app/dialogs.h"
#include "hil/app/lockstep.h"
#include "hil/source/vcd.h"

namespace kerfbench::hil {

/// What a dialog that was led leaves unproven of a recording, empty where nothing is: why it failed, unless
/// the reference controller stopped by itself.
std::string unprovenDialog(const Case& the_case, const PinRecording& recording, const LockstepResult& run);

/// What the controller itself said of the run, and of its end; what that leaves unproven is a problem, of the
/// recording as well, since a replay has no dialog that could fail.
/// @param line_cut_s when a provocation cut the line to it; NaN: it did not.
void hearController(const Case& the_case, const PreparedJob& job, const PinRecording& recording,
                    double line_cut_s, LockstepResult& run, Conclusion& conclusion);

}  // namespace kerfbench::hil
