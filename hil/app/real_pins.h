// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "hil/app/case.h"
#include "hil/app/commands.h"
#include "hil/app/console.h"
#include "hil/source/analyser/analyser.h"
#include "hil/source/gpio/capture.h"
#include "hil/source/gpio/chips.h"
#include "hil/source/serial/serial_system.h"

namespace kerfbench::hil {

/// The ways to a controller's real pins; tests script them.
struct RealPins {
  std::shared_ptr<GpioSystem> gpio;
  std::function<GpioChipList()> chips;
  std::shared_ptr<SerialSystem> serial;
  std::shared_ptr<AnalyserSystem> analysers;
};
/// Those of this computer. `bin_dir`: where kerfbench's children are.
RealPins realPins(const std::filesystem::path& bin_dir);

/// Where a scenario on real pins gets them from, for people.
std::string pinsName(const FirmwareChoice& firmware);

/// Records the pins that a case on real pins names, and drives none. @throws InputFault as captureCase().
PinCapture hearPins(const Case& the_case, const RealPins& pins, Console& console);

/// captureCommand() on these pins. @throws ConfigError; InputFault, also for a case whose controller's inputs
/// are to be driven.
int captureOnPins(const RealPins& pins, const CaptureCommandOptions& options);

}  // namespace kerfbench::hil
