// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "twin/base/pin_event.h"
#include "twin/base/signal_map.h"

namespace kerfbench::hil {

/// A run's pins as 1-bit wires, for PulseView, sigrok-cli, GTKWave and replay.
struct PinRecording {
  TickRate rate;
  std::vector<PinEvent> outputs;      ///< What the controller did, by tick.
  std::vector<SensorEdge> sensors;    ///< What the bench drove, by tick.
  Tick end{};                         ///< End of the run; the file closes with a time stamp there, since
                                      ///< sigrok drops changes at the last stamp otherwise.
};
/// Writes the whole file or nothing. The time scale is the coarsest of 1 s … 1 fs that holds a tick exactly.
void writeVcd(const std::filesystem::path& path, const PinRecording& recording, const SignalMap& map);
/// @throws std::runtime_error listing every fault with its line.
PinRecording readVcd(const std::filesystem::path& path, const SignalMap& map);

}  // namespace kerfbench::hil
