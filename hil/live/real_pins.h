// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "hil/base/console.h"
#include "hil/scenario/case.h"
#include "hil/source/analyser/analyser.h"
#include "hil/source/gpio/capture.h"
#include "hil/source/gpio/chips.h"
#include "hil/source/serial/serial_system.h"

namespace kerfbench::live {

/// Access to a controller's real pins; tests script it.
struct RealPins {
  std::shared_ptr<source::GpioSystem> gpio;
  std::function<source::GpioChipList()> chips;
  std::shared_ptr<source::SerialSystem> serial;
  std::shared_ptr<source::AnalyserSystem> analysers;
};
/// Pins of this computer. `bin_dir`: folder of kerfbench's children.
RealPins realPins(const std::filesystem::path& bin_dir);

/// Name for people of the pins that a scenario uses.
std::string pinsName(const scenario::FirmwareChoice& firmware);

/// Records the pins that a case on real pins names, and drives none. @throws InputError as captureCase().
source::PinCapture hearPins(const scenario::Case& test_case, const RealPins& pins, base::Console& console);

}  // namespace kerfbench::live
