// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hil/source/vcd.h"

namespace kerfbench::source {

/// Capture of real pins.
struct PinCapture {
  PinRecording recording;  ///< Recording from shortly before the first edge on; has a gap if it has problems.
  std::vector<std::string> notes;  ///< Circumstances, such as those that make a loss more likely.
  std::uint64_t edges{};
};

/// Ends a recording that has problems with a gap on a port that was captured, so that a replay has it too.
void spoilEnd(PinRecording& recording, std::uint16_t port);

/// Levels that signals must have before the first edge. Recordings have all pins low there.
struct StartLevels {
  std::vector<Signal> low;   ///< High ones would give drives that count rising edges one that was none.
  std::vector<Signal> high;  ///< Low ones would be taken for inactive, as pins that nobody drives.
};

/// Sentence on a signal that had the wrong level when the capture began; empty for the right one.
std::string wrongAtStartWords(Signal signal, bool level, const StartLevels& wanted);
/// Sentence on a capture that reached its time limit, after some edge or none.
std::string timeLimitWords(double time_limit_s, bool any_edge);
inline constexpr const char* kTooManyEdgesWords = "more edges came than a recording holds";
/// Most edges of lines that the kernel reads, which wait in locked memory until the job is over.
inline constexpr std::size_t kMostCapturedEdges = 50'000'000;
/// Most edges of an analyser or of its files, which go to the disk as they come.
inline constexpr std::uint64_t kMostSampledEdges = 4'000'000'000;

/// Time before the first edge that a recording keeps of a capture: the machine is at rest.
inline constexpr double kLeadBeforeEdges_s = 0.1;
/// Time after the last edge that it keeps: the mirrors settle.
inline constexpr double kTailAfterEdges_s = 0.2;

}  // namespace kerfbench::source
