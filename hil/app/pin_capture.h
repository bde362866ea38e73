// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "hil/app/case.h"
#include "hil/app/console.h"
#include "hil/source/gpio/capture.h"
#include "hil/source/gpio/chips.h"

namespace kerfbench::hil {

/// PUL of the drives that count its rising edges: they must not rest high.
std::vector<Signal> countedRising(const twin::MachineDescription& machine);

/// Records the real pins that the case names, and tells the user when to start the job, and what came.
/// @throws InputFault if the pins cannot be had: who, where, and what to do.
PinCapture captureCase(const Case& the_case, const std::shared_ptr<GpioSystem>& system,
                       const GpioChipList& chips, Console& console);

}  // namespace kerfbench::hil
