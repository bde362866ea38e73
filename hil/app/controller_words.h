// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "hil/app/controller_ear.h"
#include "hil/app/lockstep.h"
#include "hil/app/pin_sums.h"
#include "hil/inspect/controller_account.h"
#include "hil/inspect/controller_end.h"

namespace kerfbench::hil {

/// What the controller itself said of the run, as in Evidence.
struct ControllerWords {
  std::optional<ControllerAccount> account;
  std::optional<ControllerEnd> end;
};

/// The end that was heard, and whose matter it is. The release's is all but a line or a host that failed, a
/// guard that was opened (by the sensors of `recording`), and faults that this bench does not know.
ControllerEnd controllerEnd(const ControllerEar& ear, const PinSums& pins, const PinRecording& recording);

/// Why the end proves nothing; empty where it does. A dialog that failed is no problem if it did so because
/// the controller stopped.
std::string unprovenEnd(const ControllerEnd& end, const LockstepResult& run);

}  // namespace kerfbench::hil
