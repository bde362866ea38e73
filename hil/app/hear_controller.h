// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/app/case.h"
#include "hil/app/conclude.h"
#include "hil/app/dialogs.h"
#include "hil/app/lockstep.h"
#include "hil/source/vcd.h"

namespace kerfbench::hil {

/// A dialog that failed makes the run INVALID; it goes into the recording as well, since a replay has no
/// dialog that could fail.
void spoilByDialog(LockstepResult& run);

/// What the controller itself said of the run, and of its end; what that leaves unproven is a problem.
/// @param line_cut_s when a provocation cut the line to it; NaN: it did not.
void hearController(const Case& the_case, const PreparedJob& job, const PinRecording& recording,
                    double line_cut_s, LockstepResult& run, Conclusion& conclusion);

}  // namespace kerfbench::hil
