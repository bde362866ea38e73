// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/base/exit_codes.h"
#include "hil/live/record_frames.h"

namespace kerfbench::app {

/// Records the spot camera that a scenario names. Returns 0; 3 if fewer frames came than were asked for, or
/// none; base::kExitInput.
int recordFramesCommand(const live::RecordFramesOptions& options);

}  // namespace kerfbench::app
