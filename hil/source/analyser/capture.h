// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hil/source/analyser/analyser.h"
#include "hil/source/pin_capture.h"
#include "twin/base/signal_map.h"

namespace kerfbench::source {

struct AnalyserCaptureOptions {
  AnalyserRequest request;      ///< `listen` is set by the capture.
  std::vector<Signal> signals;  ///< Signal on each channel of the request; outputs that `map` has.
  double quiet_s{2.0};          ///< The job is over when no edge has come for this long; by samples.
  double time_limit_s{
      60.0};  ///< Limit of the whole capture, waiting for the first edge included; by samples.
  StartLevels at_start;
};

/// Records levels, in ticks of one sample, until the pins are quiet. An edge was somewhere in the period
/// before its stamp, so the stamp's error is declared as a tick. Once the analyser samples, whatever goes
/// wrong is a problem of the recording and never an exception.
/// @throws AnalyserError if it does not come to that, std::invalid_argument for signals that `map` does not
/// have, or for rates and times that make no whole number of samples.
PinCapture captureAnalyser(const AnalyserCaptureOptions& options, const SignalMap& map,
                           AnalyserSystem& system);

}  // namespace kerfbench::source
