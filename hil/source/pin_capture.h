// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hil/source/vcd.h"

namespace kerfbench::source {

/// What came in on real pins.
struct PinCapture {
  PinRecording recording;          ///< From a little before the first edge; has a gap if it has problems.
  std::vector<std::string> notes;  ///< Worth knowing, such as what makes a loss more likely.
  std::uint64_t edges{};
};

/// A recording that has problems ends with a gap, on a port that was heard: a replay has to know as well.
void spoilEnd(PinRecording& recording, std::uint16_t port);

/// What can be wrong with pins by whatever they are heard, in words.
std::string highAtStartWords(const std::string& signal);
/// The time limit was reached, after some edge or none.
std::string timeLimitWords(double time_limit_s, bool any_edge);
inline constexpr const char* kTooManyEdgesWords = "more edges came than a recording holds";
inline constexpr std::size_t kMostCapturedEdges = 50'000'000;

/// Whether a recording that is cut out of what was heard.
inline constexpr double kLeadBeforeEdges_s = 0.1;  ///< The machine is at rest.
inline constexpr double kTailAfterEdges_s = 0.2;   ///< Mirrors swing out.

}  // namespace kerfbench::source
