// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "hil/source/vcd.h"
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

/// The pins of a run, so many times one after the other.
source::PinRecording repeated(const RecordedRun& run, std::size_t times);

}  // namespace kerfbench::benchmarks
