// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "hil/source/vcd.h"
#include "twin/base/signal_map.h"

namespace kerfbench::live {

/// Statistics of one line in a recording.
struct LineStatistics {
  Signal signal{};
  std::uint64_t edges{};
  /// Shortest time between two edges; infinite below two.
  double shortest_s{std::numeric_limits<double>::infinity()};
  double peak_hz{};  ///< Most edges in a millisecond that begins with one, per second.
};

/// Statistics of a controller's outputs in a recording, for people who look whether all is wired.
struct PinStatistics {
  std::vector<LineStatistics> lines;  ///< One for each output of the map.
  std::uint64_t edges{};
  double span_s{};             ///< First to last edge.
  double longest_silence_s{};  ///< Longest time between two edges of any line.
};

PinStatistics pinStatistics(const source::PinRecording& recording, const SignalMap& map);

/// A line of text for each line, and one for all.
std::string pinStatisticsText(const PinStatistics& heard);

}  // namespace kerfbench::live
