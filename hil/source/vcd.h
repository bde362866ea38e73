// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hil/base/progress.h"
#include "hil/base/spilled_vector.h"
#include "hil/source/pin_events.h"
#include "twin/base/pin_event.h"
#include "twin/base/signal_map.h"

namespace kerfbench::source {

/// Bytes that the controller sent on its UART, all received at this tick.
struct ReceivedBytes {
  Tick tick{};
  std::vector<std::uint8_t> bytes;
  friend bool operator==(const ReceivedBytes&, const ReceivedBytes&) = default;
};

/// A run's pins as 1-bit wires, for PulseView, sigrok-cli, GTKWave and replay. An hour of them may be larger
/// than the memory.
struct PinRecording {
  TickRate rate;
  PinEvents outputs;                        ///< Events of the controller's outputs, by tick.
  base::SpilledVector<SensorEdge> sensors;  ///< Edges that the bench drove, by tick.
  std::vector<ReceivedBytes> uart;          ///< Bytes of the UART, by tick.
  Tick end{};                       ///< End of the run; the file closes with a time stamp there, since
                                    ///< sigrok drops changes at the last stamp otherwise.
  std::uint32_t stamp_err_ticks{};  ///< Declared bias and jitter of an event's tick; a tick each way in a
                                    ///< file of another program, which sampled.
  /// Reasons, besides gaps, not to trust the recording, in words. The file keeps them.
  std::vector<std::string> problems{};
  bool own{};  ///< Read from a file that Kerfbench wrote, so that ticks are exact.
  /// Sensors that the file has a wire for, whether it moves or not.
  std::vector<Signal> sensor_wires{};
  /// Read from a file that announces a sum of its own. One that does not fit is a problem.
  bool sealed{};
};

/// Signals of which a file of another program may lack the wire: those that the machine makes no use of.
using SpareSignals = std::vector<Signal>;

/// Names of wires or channels of a file, where they are not those of their signals.
using ChannelNames = std::vector<std::pair<Signal, std::string>>;

/// Writes the whole file or nothing. The time scale is the coarsest of 1 s … 1 fs that holds a tick exactly
/// (100 ps for 16 MHz), or 1 ps if none does. Comments that other programs skip keep what VCD has no place
/// for: the exact tick, its error, the end of the run, gaps, problems, and what the controller sent. Only
/// signals with a wire of their own are written (SignalMap::hasOwnWire); what a port does on other pins is
/// lost. The last line is the SHA-256 of all before it, which is returned: equal for equal recordings.
/// @throws std::invalid_argument if the events are not in order, std::system_error with the path.
std::string writeVcd(const std::filesystem::path& path, const PinRecording& recording, const SignalMap& map,
                     const base::ProgressFn& progress = {});

/// Reads such a file, or any VCD that names its 1-bit wires as `names` or signalName() do; other wires are
/// skipped. A file that Kerfbench wrote has signalName() alone.
/// Without Kerfbench's comments a tick is one unit of the time scale. Changes of a port at one stamp become
/// one event.
///
/// A file whose header announces a sum that does not fit any more has a problem, so that no verdict rests on
/// it: somebody cut, edited or converted it. Whoever wants that judged takes Kerfbench's comments out of the
/// header.
///
/// Strict, because evidence depends on it: stamps that go back, levels other than 0 and 1 on a wired pin, a
/// change of such a pin to the level that it has (outside of a dump), unknown identifiers, a wire twice, a
/// controller's pin of `map` that the file lacks (but for `spare`, in a file of another program), a word or
/// section of more than 64 MiB, and anything truncated are refused. The file may be of any size: it is read
/// in pieces.
/// @throws std::runtime_error listing every fault (the first 20) with its line, std::system_error with the
/// path, also of a folder that has no room for the recording (see base::SpilledVector).
PinRecording readVcd(const std::filesystem::path& path, const SignalMap& map, const ChannelNames& names,
                     const SpareSignals& spare = {}, const base::ProgressFn& progress = {});
inline PinRecording readVcd(const std::filesystem::path& path, const SignalMap& map,
                            const base::ProgressFn& progress = {}) {
  return readVcd(path, map, ChannelNames(), SpareSignals(), progress);
}

/// The sum with which a file of Kerfbench ends; nullopt if it has none, or one that does not fit the file.
/// @throws std::system_error with the path.
std::optional<std::string> vcdSum(const std::filesystem::path& path);

}  // namespace kerfbench::source
