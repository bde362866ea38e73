// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "twin/base/pin_event.h"
#include "twin/cutter/twin.h"

namespace kerfbench::benchmarks {

/// Pins of a real run, with the machine that it drives.
struct RecordedRun {
  std::string name;
  twin::MachineDescription machine;
  twin::WebDescription web;
  TickRate rate;
  std::vector<PinEvent> events;
  Tick end{};
};

/// Runs the native build of the reference controller through a scenario, and records its pins.
/// @throws std::runtime_error if the run does not come to its end.
RecordedRun record(const std::filesystem::path& scenario, const std::filesystem::path& bin_dir);

/// Plays (0, end] into a new twin as the bench does, sensors and exposures of each quantum included, and
/// returns the simulated seconds.
double play(const RecordedRun& run, Tick end, const twin::TwinOptions& options);

}  // namespace kerfbench::benchmarks
