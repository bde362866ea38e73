// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/base/yaml_reader.h"
#include "hil/source/gpio/capture.h"
#include "hil/source/gpio/chips.h"
#include "twin/base/signal_map.h"

namespace kerfbench::hil {

/// Real pins as a scenario names them (`firmware: {source: gpio, …}`).
struct GpioChoice {
  struct Line {
    Signal signal{};
    std::string line;   ///< Number or name.
    std::string place;  ///< "file:line: firmware.lines.galvo_x_pul", for faults that come up later.
  };
  std::string chip;  ///< Path, name or label.
  std::string place;
  std::vector<Line> lines;
  double stamp_err_s{};
  double quiet_s{};
};

/// What is wrong goes to the reader.
GpioChoice readGpioChoice(YamlReader& firmware);

/// Lines of signals that the machine does not have, and outputs that it has and the choice has no line for:
/// its laser's, and its axes' (`gantry` or mirrors; a sheet at rest has no feed). One fault a line, with file
/// and line; empty: none.
std::string faultsOf(const GpioChoice& choice, const SignalMap& machine, bool gantry);

/// What capturePins() needs, but for its time limit. @throws GpioError with every line that the chip does not
/// have, or that two signals share, with file and line of the scenario.
GpioCaptureOptions captureOptions(const GpioChoice& choice, const GpioChipList& chips);

}  // namespace kerfbench::hil
