// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/app/case.h"
#include "hil/app/console.h"
#include "hil/source/analyser/capture.h"

namespace kerfbench::hil {

/// As captureCase(), by the logic analyser that the case names.
/// @throws InputFault if the analyser cannot be had: which, where, and what there is.
PinCapture captureAnalyserCase(const Case& the_case, AnalyserSystem& analysers, Console& console);

}  // namespace kerfbench::hil
