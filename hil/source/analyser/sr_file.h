// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "hil/base/progress.h"
#include "hil/source/vcd.h"
#include "twin/base/signal_map.h"

namespace kerfbench::source {

/// Reads a session file of sigrok (a zip with metadata and samples), as sigrok-cli and PulseView save it. A
/// tick is a sample, and an edge was somewhere in the period before its stamp. A signal is on the channel of
/// its name in `names`, or of its own; channels of other names are skipped.
///
/// Strict, because evidence depends on it: outputs of `names` (of `map`, if there are none) without a
/// channel, channels twice, more than one device, missing or damaged parts and half a sample are refused.
/// Problems that writeSr() found stay.
/// @throws std::runtime_error listing every fault, with the path.
PinRecording readSr(const std::filesystem::path& path, const SignalMap& map, const ChannelNames& names,
                    const base::ProgressFn& progress = {});

/// A session file that is written has fewer samples.
inline constexpr std::uint64_t kMostSrSamples = std::uint64_t{1} << 36U;

/// Writes such a file: a channel for each signal of `map`, a sample for each tick. Whole or not at all. What
/// the controller said is lost; problems and gaps stay in a part of the zip that sigrok does not read, and
/// does not keep.
/// @throws std::invalid_argument for ticks that are no whole rate, or kMostSrSamples of them;
/// std::runtime_error with the path.
void writeSr(const std::filesystem::path& path, const PinRecording& recording, const SignalMap& map);

}  // namespace kerfbench::source
