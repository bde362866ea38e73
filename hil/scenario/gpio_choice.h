// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hil/base/yaml_reader.h"
#include "hil/source/gpio/capture.h"
#include "hil/source/gpio/chips.h"
#include "hil/source/gpio/live_source.h"
#include "twin/base/signal_map.h"

namespace kerfbench::scenario {

/// A line of a chip, or a channel of an analyser, as a scenario names it.
struct PinLine {
  Signal signal{};
  std::string line;   ///< Number or name.
  std::string place;  ///< "file:line: firmware.lines.galvo_x_pul", for faults that come up later.
};
/// `firmware.lines` and `firmware.quiet_s`; what is wrong goes to the reader.
std::vector<PinLine> readPinLines(base::YamlReader& firmware);
double readQuiet_s(base::YamlReader& firmware);

/// Real pins as a scenario names them (`firmware: {source: gpio, …}`).
struct GpioChoice {
  std::string chip;  ///< Path, name or label.
  std::string place;
  std::vector<PinLine> lines;
  double stamp_err_s{};
  double quiet_s{};
  std::vector<PinLine> outputs;  ///< Inputs of the controller, which the bench drives.
  std::string out_chip;          ///< Chip of `outputs`; path, name or label.
  std::string out_place;
  std::optional<double> max_lag_s;  ///< Most that an edge is driven late; absent: from the belt's speed.
  std::string uart;                 ///< Serial line to the controller; empty: none.
  std::string uart_place;
  double uart_wait_s{};  ///< Wait after the port was opened, as some boards start anew then.
  /// A byte is read at most so long after it was on the wire: adapters on USB hold a short packet back.
  double uart_delay_s{};

  /// The model runs while the pins are read.
  [[nodiscard]] bool isLive() const { return !outputs.empty() || !uart.empty(); }
};

/// Reads the choice; faults go to the reader.
GpioChoice readGpioChoice(base::YamlReader& firmware);

/// Needs of a case on real pins.
struct WiringNeeds {
  bool gantry{};  ///< Motors of a gantry are wired instead of those of mirrors. A line's belt has no feed.
  bool moving_sheet{};  ///< Encoder and print mark are driven.
};
/// Lines of signals that the machine does not have, and pins that it has and the choice has no line for. One
/// fault a line, with file and line; empty: none.
std::string faultsOf(const GpioChoice& choice, const SignalMap& machine, const WiringNeeds& needs);
/// Faults of the controller's outputs alone: those of its laser and of its axes (`gantry` or mirrors).
/// `place`: place of the choice.
std::string faultsOf(const std::vector<PinLine>& lines, const std::string& place, const SignalMap& machine,
                     bool gantry);

/// Options of capturePins() but for its time limit. @throws GpioError with every line that the chip does not
/// have, or that two signals share, with file and line of the scenario.
source::GpioCaptureOptions captureOptions(const GpioChoice& choice, const source::GpioChipList& chips);
/// Options of a live run, with the lines that are driven. @throws GpioError as captureOptions().
source::GpioLiveOptions liveOptions(const GpioChoice& choice, const source::GpioChipList& chips);

}  // namespace kerfbench::scenario
