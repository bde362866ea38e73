// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/base/exit_codes.h"
#include "hil/live/capture_on_pins.h"

namespace kerfbench::app {

/// Records the real pins that a scenario names to a folder, without model and verdict. Returns 0, 3 if the
/// recording cannot be trusted, base::kExitBroken if the session file alone could not be written, or
/// base::kExitInput.
int captureCommand(const live::CaptureOptions& options);

}  // namespace kerfbench::app
