// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/base/console.h"
#include "hil/live/real_pins.h"
#include "hil/run/dialogs.h"
#include "hil/scenario/case.h"
#include "hil/source/gpio/capture.h"
#include "hil/source/gpio/lag_meter.h"
#include "twin/description/imperfections.h"

namespace kerfbench::live {

/// Result of a live run.
struct LivePins {
  /// Sensors as they were driven, and the UART, included; what the dialog left unproven is a problem of it.
  source::PinCapture captured;
  source::LagMeter lag, switch_lag;  ///< Lag of the driven edges behind their plan; see GpioLiveRecord.
};

/// Number and lateness of the driven edges, for people.
std::string drivenWords(const LivePins& live);

/// Runs a case on real pins while a model of the machine drives the controller's inputs, and talks to the
/// controller if there is a serial line. @throws InputError if pins or line cannot be had.
LivePins runLive(const scenario::Case& test_case, const twin::SampledMachine& sampled, const RealPins& pins,
                 const run::PreparedJob& job, base::Console& console);

}  // namespace kerfbench::live
