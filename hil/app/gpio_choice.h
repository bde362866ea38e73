// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/base/yaml_reader.h"
#include "hil/source/gpio/capture.h"
#include "hil/source/gpio/chips.h"
#include "twin/base/signal_map.h"

namespace kerfbench::hil {

/// A line of a chip, or a channel of an analyser, as a scenario names it.
struct PinLine {
  Signal signal{};
  std::string line;   ///< Number or name.
  std::string place;  ///< "file:line: firmware.lines.galvo_x_pul", for faults that come up later.
};
/// `firmware.lines` and `firmware.quiet_s`; what is wrong goes to the reader.
std::vector<PinLine> readPinLines(YamlReader& firmware);
double readQuiet_s(YamlReader& firmware);

/// Real pins as a scenario names them (`firmware: {source: gpio, …}`).
struct GpioChoice {
  std::string chip;  ///< Path, name or label.
  std::string place;
  std::vector<PinLine> lines;
  double stamp_err_s{};
  double quiet_s{};
};

/// What is wrong goes to the reader.
GpioChoice readGpioChoice(YamlReader& firmware);

/// Lines of signals that the machine does not have, and outputs that it has and the choice has no line for:
/// its laser's, and its axes' (`gantry` or mirrors; a sheet at rest has no feed). `place`: of the choice. One
/// fault a line, with file and line; empty: none.
std::string faultsOf(const std::vector<PinLine>& lines, const std::string& place, const SignalMap& machine,
                     bool gantry);

/// What capturePins() needs, but for its time limit. @throws GpioError with every line that the chip does not
/// have, or that two signals share, with file and line of the scenario.
GpioCaptureOptions captureOptions(const GpioChoice& choice, const GpioChipList& chips);

}  // namespace kerfbench::hil
