// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "hil/app/case.h"
#include "hil/app/console.h"
#include "hil/source/gpio/capture.h"
#include "hil/source/gpio/chips.h"

namespace kerfbench::hil {

/// PUL of each axis that a machine can have, with its axis; for machines without one it says nothing.
std::array<std::pair<Signal, const twin::AxisDescription*>, 5> pulAxes(
    const twin::MachineDescription& machine);
/// PUL of the drives that count its rising edges.
std::vector<Signal> countedRising(const twin::MachineDescription& machine);
/// What came, and what is worth knowing.
void tellCapture(const PinCapture& captured, Console& console);

/// Records the real pins that the case names, and tells the user when to start the job, and what came.
/// @throws InputFault if the pins cannot be had: who, where, and what to do.
PinCapture captureCase(const Case& the_case, const std::shared_ptr<GpioSystem>& system,
                       const GpioChipList& chips, Console& console);

}  // namespace kerfbench::hil
