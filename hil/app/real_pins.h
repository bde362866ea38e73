// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include "hil/app/case.h"
#include "hil/app/commands.h"
#include "hil/app/console.h"
#include "hil/app/stopwatch.h"
#include "hil/source/gpio/chips.h"
#include "hil/source/serial/serial_system.h"

namespace kerfbench::hil {

/// The ways to a controller's real pins; tests script them.
struct RealPins {
  std::shared_ptr<GpioSystem> gpio;
  std::function<GpioChipList()> chips;
  std::shared_ptr<SerialSystem> serial;
};
/// Those of this computer.
RealPins realPins();

/// Runs a case on real pins and judges it. Whether the model runs along to drive the controller's inputs or
/// not, what is judged is the recording, with the model behind it: nothing that is slow there makes anything
/// late, and a replay of the recording is the same evidence. Returns the exit code of the verdict.
/// @throws InputFault if the pins cannot be had: who, where, and what to do.
int runOnPins(const Case& the_case, const RealPins& pins, const CommonOptions& options, Stopwatch& stopwatch,
              Console& console);

}  // namespace kerfbench::hil
