// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "hil/live/real_pins.h"

namespace kerfbench::live {

/// Options of a recording of pins without model and verdict.
struct CaptureOptions {
  std::filesystem::path scenario;
  std::filesystem::path out;           ///< Folder; empty: results/NAME-capture.
  std::optional<double> time_limit_s;  ///< Real; instead of the scenario's.
  bool session{};                      ///< Writes pins.sr in addition to pins.vcd.
  bool quiet{};
  std::filesystem::path bin_dir;
};

/// Records the pins that a scenario names to a folder. Returns 0, 3 if the recording cannot be trusted,
/// kExitBroken if the session file alone could not be written. @throws ConfigError; InputError, also for a
/// case whose controller's inputs are to be driven.
int captureOnPins(const RealPins& pins, const CaptureOptions& options);

}  // namespace kerfbench::live
