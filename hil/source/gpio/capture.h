// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hil/source/gpio/edge_order.h"
#include "hil/source/gpio/system.h"
#include "hil/source/gpio/wires.h"
#include "hil/source/pin_capture.h"
#include "twin/base/signal_map.h"

namespace kerfbench::source {

struct GpioCaptureOptions {
  std::filesystem::path chip;   ///< Path such as "/dev/gpiochip0".
  std::vector<GpioWire> wires;  ///< Outputs that `map` has; one without a wire stays low.
  double stamp_err_s{};         ///< Declared bias and jitter of a time stamp.
  double quiet_s{2.0};          ///< The job is over when no edge has come for this long.
  double time_limit_s{60.0};    ///< Limit of the whole capture, waiting for the first edge included.
  StartLevels at_start;
  /// Is told of edges as they are had, so long after the begin; may be empty. It must not wait.
  std::function<void(std::uint64_t now_ns, std::span<const LineEdge> edges)> heard{};
};

/// Records edges, in ticks of 1 ns, until the pins are quiet. Once the lines are had, whatever goes wrong is
/// a problem in the result and never an exception: what came until then is evidence of something.
/// @throws GpioError if the lines cannot be had, std::invalid_argument for wires that `map` does not have.
PinCapture capturePins(const GpioCaptureOptions& options, const SignalMap& map,
                       const std::shared_ptr<GpioSystem>& system);

}  // namespace kerfbench::source
