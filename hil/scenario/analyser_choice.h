// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "hil/base/yaml_reader.h"
#include "hil/scenario/gpio_choice.h"
#include "hil/source/analyser/capture.h"
#include "twin/description/description.h"

namespace kerfbench::scenario {

/// Real pins by a logic analyser as a scenario names them (`firmware: {source: analyser, …}`).
struct AnalyserChoice {
  std::string driver;  ///< libsigrok's name.
  std::string conn;    ///< Empty: whatever the driver finds.
  std::string serial;  ///< Empty: any.
  std::string place;   ///< "file:line: firmware.driver".
  std::uint64_t samplerate_hz{};
  std::string rate_place;
  std::vector<std::pair<std::string, std::string>> settings;  ///< Settings of the driver, by sigrok's names.
  std::vector<PinLine> lines;                                 ///< Lines by the names of their channels.
  double quiet_s{};
};

/// A pulse of the least width that a drive takes must be this many samples long: one less is seen of it at
/// the worst, and its width is known to a third.
inline constexpr double kLeastSamples = 4.0;

/// Reads the choice; faults go to the reader.
AnalyserChoice readAnalyserChoice(base::YamlReader& firmware);

/// A drive of the machine whose shortest pulses (width, space) have less than kLeastSamples at a rate.
struct SlowRate {
  Signal pul{};
  std::string words;  ///< Sentence on the rate that is enough.
};
std::vector<SlowRate> tooSlowFor(const twin::MachineDescription& machine, std::uint64_t samplerate_hz);

/// Faults of the lines, and of a rate that is too low for the pulses (width, space) of a drive that is
/// captured.
std::string faultsOf(const AnalyserChoice& choice, const twin::MachineDescription& machine);

/// Options of captureAnalyser() but for its time limit and the signals that must be low at the start.
source::AnalyserCaptureOptions captureOptions(const AnalyserChoice& choice);

}  // namespace kerfbench::scenario
